// Explicit Runge-Kutta methods as data.
//
// A pair advances y' = f(t, y) by   k_i = f(t + c_i h, y + h sum_j a_ij k_j),   y_1 = y + h sum_j b_j k_j.
// Conventions of this file:
//   - "first same as last": row kStages - 1 of `a` is b, so the last stage is f at the step's end;
//   - rows kStages .. kDenseStages - 1 are evaluated only when the interior of a step is needed;
//   - dense output: y(t + s h) = y + h sum_i b_i(s) k_i with b_i(s) = sum_d p[i][d] s^(d+1), 0 <= s <= 1;
//   - `e` are the weights of the embedded error estimates (none: a fixed step), which `error_norm` combines into the
//     error that the step control keeps below 1; both are in units of the tolerance.
// Tests: test/convergence/order.cpp (order, dense order, exactness on polynomials).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace ukemi::integrate {

/// The classical fourth-order method at a fixed step, with the cubic through both ends and their slopes inside it (a
/// fifth stage, f at the end, which is the next step's first). Source: W. Kutta, Z. Math. Phys. 46 (1901) 435-453.
struct RungeKutta4 {
  static constexpr const char* kName = "rk4";
  static constexpr int kOrder = 4, kErrorOrder = 4, kDenseOrder = 3;
  static constexpr int kStages = 5, kDenseStages = 5, kDenseDegree = 3, kEstimates = 0;
  static constexpr double c[kDenseStages] = {0, 1. / 2, 1. / 2, 1, 1};
  static constexpr double a[kDenseStages][kDenseStages] = {
      {}, {1. / 2}, {0, 1. / 2}, {0, 0, 1}, {1. / 6, 1. / 3, 1. / 3, 1. / 6}};
  static constexpr std::array<std::array<double, kStages>, 0> e{};
  static constexpr std::array<std::array<double, kDenseDegree>, kDenseStages> p = {
      {{1, -3. / 2, 2. / 3}, {0, 1, -2. / 3}, {0, 1, -2. / 3}, {0, 1. / 2, -1. / 3}, {0, -1, 1}}};
  static double error_norm(const std::array<double, 0>&, double) { return 0; }
};

/// Dormand-Prince 5(4) with the free fourth-order interpolant of Shampine.
/// Source: J. R. Dormand, P. J. Prince, J. Comput. Appl. Math. 6 (1980) 19-26; L. F. Shampine, Math. Comp. 46 (1986)
/// 135-150.
struct DormandPrince54 {
  static constexpr const char* kName = "dopri5";
  static constexpr int kOrder = 5, kErrorOrder = 4, kDenseOrder = 4;
  static constexpr int kStages = 7, kDenseStages = 7, kDenseDegree = 4, kEstimates = 1;
  static constexpr double kStabilityBoundary = 3.25;  ///< on the negative real axis, for `Automatic`
  static constexpr double c[kDenseStages] = {0, 1. / 5, 3. / 10, 4. / 5, 8. / 9, 1, 1};
  static constexpr double a[kDenseStages][kDenseStages] = {
      {},
      {1. / 5},
      {3. / 40, 9. / 40},
      {44. / 45, -56. / 15, 32. / 9},
      {19372. / 6561, -25360. / 2187, 64448. / 6561, -212. / 729},
      {9017. / 3168, -355. / 33, 46732. / 5247, 49. / 176, -5103. / 18656},
      {35. / 384, 0, 500. / 1113, 125. / 192, -2187. / 6784, 11. / 84},
  };
  static constexpr double e[kEstimates][kStages] = {
      {71. / 57600, 0, -71. / 16695, 71. / 1920, -17253. / 339200, 22. / 525, -1. / 40}};
  static constexpr std::array<std::array<double, kDenseDegree>, kDenseStages> p = {{
      {1, -8048581381. / 2820520608, 8663915743. / 2820520608, -12715105075. / 11282082432},
      {0, 0, 0, 0},
      {0, 131558114200. / 32700410799, -68118460800. / 10900136933, 87487479700. / 32700410799},
      {0, -1754552775. / 470086768, 14199869525. / 1410260304, -10690763975. / 1880347072},
      {0, 127303824393. / 49829197408, -318862633887. / 49829197408, 701980252875. / 199316789632},
      {0, -282668133. / 205662961, 2019193451. / 616988883, -1453857185. / 822651844},
      {0, 40617522. / 29380423, -110615467. / 29380423, 69997945. / 29380423},
  }};
  static double error_norm(const std::array<double, kEstimates>& estimate, double) { return estimate[0]; }
};

/// Dormand-Prince 8(5,3), DOP853, with its seventh-order interpolant (three further stages).
/// Source: E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd ed. (1993), II.5, II.6,
/// II.10.
struct DormandPrince853 {
  static constexpr const char* kName = "dop853";
  static constexpr int kOrder = 8, kErrorOrder = 7, kDenseOrder = 7;
  static constexpr int kStages = 13, kDenseStages = 16, kDenseDegree = 7, kEstimates = 2;
  static constexpr double kStabilityBoundary = 6.1;  ///< on the negative real axis, for `Automatic`
  static constexpr double c[kDenseStages] = {0.0,
                                             0.526001519587677318785587544488e-01,
                                             0.789002279381515978178381316732e-01,
                                             0.118350341907227396726757197510,
                                             0.281649658092772603273242802490,
                                             0.333333333333333333333333333333,
                                             0.25,
                                             0.307692307692307692307692307692,
                                             0.651282051282051282051282051282,
                                             0.6,
                                             0.857142857142857142857142857142,
                                             1.0,
                                             1.0,
                                             0.1,
                                             0.2,
                                             0.777777777777777777777777777778};
  static constexpr double a[kDenseStages][kDenseStages] = {
      {},
      {5.26001519587677318785587544488e-2},
      {1.97250569845378994544595329183e-2, 5.91751709536136983633785987549e-2},
      {2.95875854768068491816892993775e-2, 0, 8.87627564304205475450678981324e-2},
      {2.41365134159266685502369798665e-1, 0, -8.84549479328286085344864962717e-1, 9.24834003261792003115737966543e-1},
      {3.7037037037037037037037037037e-2, 0, 0, 1.70828608729473871279604482173e-1, 1.25467687566822425016691814123e-1},
      {3.7109375e-2, 0, 0, 1.70252211019544039314978060272e-1, 6.02165389804559606850219397283e-2, -1.7578125e-2},
      {3.70920001185047927108779319836e-2, 0, 0, 1.70383925712239993810214054705e-1, 1.07262030446373284651809199168e-1,
       -1.53194377486244017527936158236e-2, 8.27378916381402288758473766002e-3},
      {6.24110958716075717114429577812e-1, 0, 0, -3.36089262944694129406857109825, -8.68219346841726006818189891453e-1,
       2.75920996994467083049415600797e1, 2.01540675504778934086186788979e1, -4.34898841810699588477366255144e1},
      {4.77662536438264365890433908527e-1, 0, 0, -2.48811461997166764192642586468, -5.90290826836842996371446475743e-1,
       2.12300514481811942347288949897e1, 1.52792336328824235832596922938e1, -3.32882109689848629194453265587e1,
       -2.03312017085086261358222928593e-2},
      {-9.3714243008598732571704021658e-1, 0, 0, 5.18637242884406370830023853209, 1.09143734899672957818500254654,
       -8.14978701074692612513997267357, -1.85200656599969598641566180701e1, 2.27394870993505042818970056734e1,
       2.49360555267965238987089396762, -3.0467644718982195003823669022},
      {2.27331014751653820792359768449, 0, 0, -1.05344954667372501984066689879e1, -2.00087205822486249909675718444,
       -1.79589318631187989172765950534e1, 2.79488845294199600508499808837e1, -2.85899827713502369474065508674,
       -8.87285693353062954433549289258, 1.23605671757943030647266201528e1, 6.43392746015763530355970484046e-1},
      {5.42937341165687622380535766363e-2, 0, 0, 0, 0, 4.45031289275240888144113950566, 1.89151789931450038304281599044,
       -5.8012039600105847814672114227, 3.1116436695781989440891606237e-1, -1.52160949662516078556178806805e-1,
       2.01365400804030348374776537501e-1, 4.47106157277725905176885569043e-2},
      {5.61675022830479523392909219681e-2, 0, 0, 0, 0, 0, 2.53500210216624811088794765333e-1,
       -2.46239037470802489917441475441e-1, -1.24191423263816360469010140626e-1, 1.5329179827876569731206322685e-1,
       8.20105229563468988491666602057e-3, 7.56789766054569976138603589584e-3, -8.298e-3},
      {3.18346481635021405060768473261e-2, 0, 0, 0, 0, 2.83009096723667755288322961402e-2,
       5.35419883074385676223797384372e-2, -5.49237485713909884646569340306e-2, 0, 0,
       -1.08347328697249322858509316994e-4, 3.82571090835658412954920192323e-4, -3.40465008687404560802977114492e-4,
       1.41312443674632500278074618366e-1},
      {-4.28896301583791923408573538692e-1, 0, 0, 0, 0, -4.69762141536116384314449447206,
       7.68342119606259904184240953878, 4.06898981839711007970213554331, 3.56727187455281109270669543021e-1, 0, 0, 0,
       -1.39902416515901462129418009734e-3, 2.9475147891527723389556272149, -9.15095847217987001081870187138},
  };
  static constexpr double e5[kStages] = {0.1312004499419488073250102996e-1,
                                         0,
                                         0,
                                         0,
                                         0,
                                         -0.1225156446376204440720569753e1,
                                         -0.4957589496572501915214079952,
                                         0.1664377182454986536961530415e1,
                                         -0.3503288487499736816886487290,
                                         0.3341791187130174790297318841,
                                         0.8192320648511571246570742613e-1,
                                         -0.2235530786388629525884427845e-1,
                                         0};
  static constexpr double d[4][kDenseStages] = {
      {-0.84289382761090128651353491142e1, 0, 0, 0, 0, 0.56671495351937776962531783590,
       -0.30689499459498916912797304727e1, 0.23846676565120698287728149680e1, 0.21170345824450282767155149946e1,
       -0.87139158377797299206789907490, 0.22404374302607882758541771650e1, 0.63157877876946881815570249290,
       -0.88990336451333310820698117400e-1, 0.18148505520854727256656404962e+2, -0.91946323924783554000451984436e1,
       -0.44360363875948939664310572000e1},
      {0.10427508642579134603413151009e+2, 0, 0, 0, 0, 0.24228349177525818288430175319e+3,
       0.16520045171727028198505394887e+3, -0.37454675472269020279518312152e+3, -0.22113666853125306036270938578e+2,
       0.77334326684722638389603898808e1, -0.30674084731089398182061213626e+2, -0.93321305264302278729567221706e1,
       0.15697238121770843886131091075e+2, -0.31139403219565177677282850411e+2, -0.93529243588444783865713862664e1,
       0.35816841486394083752465898540e+2},
      {0.19985053242002433820987653617e+2, 0, 0, 0, 0, -0.38703730874935176555105901742e+3,
       -0.18917813819516756882830838328e+3, 0.52780815920542364900561016686e+3, -0.11573902539959630126141871134e+2,
       0.68812326946963000169666922661e1, -0.10006050966910838403183860980e1, 0.77771377980534432092869265740,
       -0.27782057523535084065932004339e1, -0.60196695231264120758267380846e+2, 0.84320405506677161018159903784e+2,
       0.11992291136182789328035130030e+2},
      {-0.25693933462703749003312586129e+2, 0, 0, 0, 0, -0.15418974869023643374053993627e+3,
       -0.23152937917604549567536039109e+3, 0.35763911791061412378285349910e+3, 0.93405324183624310003907691704e+2,
       -0.37458323136451633156875139351e+2, 0.10409964950896230045147246184e+3, 0.29840293426660503123344363579e+2,
       -0.43533456590011143754432175058e+2, 0.96324553959188282948394950600e+2, -0.39177261675615439165231486172e+2,
       -0.14972683625798562581422125276e+3},
  };
  /// Error weights of order 5 and 3; e3 = b minus the third-order formula on stages 1, 9, 12.
  static constexpr auto e = [] {
    std::array<std::array<double, kStages>, kEstimates> w{};
    for (int i = 0; i < kStages; ++i) w[0][i] = e5[i], w[1][i] = i < 12 ? a[12][i] : 0;
    w[1][0] -= 0.244094488188976377952755905512;
    w[1][8] -= 0.733846688281611857341361741547;
    w[1][11] -= 0.220588235294117647058823529412e-1;
    return w;
  }();
  /// The nested form of (10.5), x F0 + x (1-x) F1 + x^2 (1-x) F2 + ..., expanded into powers of s.
  static constexpr auto p = [] {
    std::array<std::array<double, kDenseDegree>, kDenseStages> out{};
    for (int i = 0; i < kDenseStages; ++i) {
      const double b = i < 12 ? a[12][i] : 0, first = i == 0, last = i == 12;
      const double f[7] = {b, first - b, 2 * b - first - last, d[0][i], d[1][i], d[2][i], d[3][i]};
      double poly[8] = {};  // coefficients of s^0 .. s^7, built from the innermost factor outwards
      for (int m = 6; m >= 0; --m) {
        poly[0] += f[m];
        for (int q = 7; q >= 0; --q)
          poly[q] = m % 2 == 0 ? (q > 0 ? poly[q - 1] : 0) : poly[q] - (q > 0 ? poly[q - 1] : 0);
      }
      for (int q = 0; q < kDenseDegree; ++q) out[i][q] = poly[q + 1];
    }
    return out;
  }();
  /// Hairer's combination, an estimate of eighth order by the ratio of the two. In a step too long for either, such as
  /// the first after a jump of the field, it is a small quotient of two large numbers and means nothing: the
  /// fifth-order estimate itself must stay below kFifth tolerances at an accuracy of 1e-9, three times its value in
  /// steps that the combination rightly accepts; that value grows as accuracy^(-1/4).
  static double error_norm(const std::array<double, kEstimates>& estimate, double accuracy) {
    constexpr double kFifth = 100, kAt = 1e-9;
    const double fifth = estimate[0], denominator = std::hypot(fifth, 0.1 * estimate[1]);
    if (!std::isfinite(denominator)) return denominator;  // never a small quotient of two overflows
    const double combined = denominator > 0 ? fifth * (fifth / denominator) : 0;
    return std::max(combined, fifth / (kFifth * std::sqrt(std::sqrt(kAt / accuracy))));
  }
};

}  // namespace ukemi::integrate
