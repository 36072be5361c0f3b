// The instruction set of a kernel that is compiled with UKEMI_BATCH_LANES lanes.
#pragma once

#if !defined(__x86_64__) || UKEMI_BATCH_LANES == 2
#define UKEMI_BATCH_TARGET
#elif UKEMI_BATCH_LANES == 4
#define UKEMI_BATCH_TARGET [[gnu::target("avx2,fma")]]
#else
#define UKEMI_BATCH_TARGET [[gnu::target("avx512f,avx512dq,avx512vl,avx2,fma,prefer-vector-width=512")]]
#endif

// Clang does not inline into functions of another target, and rejects Eigen's alignment of wide packs (3.4): it
// compiles only the baseline.
#if defined(__clang__) && UKEMI_BATCH_LANES != 2
#define UKEMI_BATCH_BASELINE_ALONE
#endif
