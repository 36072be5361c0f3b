// The entries of batch_engine.hpp, one for each instruction set and set of terms; private to landing.
#pragma once

#include "landing/lanes/batch.hpp"

namespace ukemi::landing {

void run_batch_baseline(BatchSource& source, const BatchOptions& options);
void run_batch_avx2(BatchSource& source, const BatchOptions& options);
void run_batch_avx512(BatchSource& source, const BatchOptions& options);

}  // namespace ukemi::landing
