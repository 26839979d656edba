#include "rigel/minimal/catalogue.h"

#include "rigel/core/enum_names.h"
#include "rigel/minimal/solvers/five_point_plus_one.h"
#include "rigel/minimal/solvers/four_point.h"
#include "rigel/minimal/solvers/four_point_approx.h"
#include "rigel/minimal/solvers/four_point_lee.h"
#include "rigel/minimal/solvers/four_point_liu.h"
#include "rigel/minimal/solvers/four_point_sweeney.h"
#include "rigel/minimal/solvers/seventeen_point_li.h"
#include "rigel/minimal/solvers/six_point_stewenius.h"
#include "rigel/minimal/solvers/six_point_ventura.h"
#include "rigel/minimal/solvers/three_point.h"
#include "rigel/minimal/solvers/three_point_approx.h"
#include "rigel/minimal/solvers/two_point_ackermann.h"
#include "rigel/minimal/solvers/two_point_choi.h"

namespace rigel {
namespace {

constexpr EnumName<PriorKind> kPriorKindNames[] = {{PriorKind::kNone, "none"},
                                                   {PriorKind::kVertical, "known vertical"},
                                                   {PriorKind::kAxis, "known axis"},
                                                   {PriorKind::kPlanar, "planar"}};

}  // namespace

const std::vector<SolverInfo>& SolverCatalogue() {
  static const std::vector<SolverInfo> catalogue = {
      {"4pt-approx", 4, PriorKind::kVertical, 3, false, SampleKind::kSpread, &Solve4ptApprox,
       "Li, Liu, Han, Lv, section 4.1, eqs. d1_1-d5"},
      {"4pt-axis-approx", 4, PriorKind::kAxis, 3, false, SampleKind::kSpread, &Solve4ptApprox,
       "Li, Liu, Han, Lv, section 4.2, eqs. g2-g6"},
      {"3pt-approx", 3, PriorKind::kPlanar, 2, false, SampleKind::kSpread, &Solve3ptApprox,
       "Li, Liu, Han, Lv, section 4.3, eqs. h1-h11"},
      {"4pt-approx-polished", 4, PriorKind::kVertical, 3, false, SampleKind::kSpread,
       &Solve4ptApproxPolished, "4pt-approx with Newton steps on the exact determinant"},
      {"4pt-axis-approx-polished", 4, PriorKind::kAxis, 3, false, SampleKind::kSpread,
       &Solve4ptApproxPolished, "4pt-axis-approx with Newton steps on the exact determinant"},
      {"3pt-approx-polished", 3, PriorKind::kPlanar, 3, false, SampleKind::kSpread,
       &Solve3ptApproxPolished, "3pt-approx with Newton steps on the exact determinant"},
      {"4pt", 4, PriorKind::kVertical, 6, true, SampleKind::kSpread, &Solve4pt,
       "Li, Liu, Han, Lv, eq. d5 with the exact rotation d1"},
      {"4pt-axis", 4, PriorKind::kAxis, 6, true, SampleKind::kSpread, &Solve4pt,
       "Li, Liu, Han, Lv, eq. g6 with the exact rotation g1"},
      {"3pt", 3, PriorKind::kPlanar, 4, true, SampleKind::kSpread, &Solve3pt,
       "Li, Liu, Han, Lv, eq. h11 with the exact rotation h1"},
      {"4pt-lee", 4, PriorKind::kVertical, 6, true, SampleKind::kSpread, &Solve4ptLee,
       "Lee, Pollefeys, Fraundorfer, CVPR 2014: 8th degree polynomial"},
      {"4pt-liu", 4, PriorKind::kVertical, 4, false, SampleKind::kSpread, &Solve4ptLiu,
       "Liu, Li, Dai, Pan, 2017: first order, 4th degree polynomial"},
      {"4pt-sweeney", 4, PriorKind::kAxis, 6, true, SampleKind::kSpread, &Solve4ptSweeney,
       "Sweeney, Flynn, Turk, 3DV 2014: quadratic eigenvalue problem"},
      {"17pt-li", 17, PriorKind::kNone, 2, true, SampleKind::kSpread, &Solve17ptLi,
       "Li, Hartley, Kim, CVPR 2008: linear, for locally central rigs too", 5.0},
      {"6pt-stewenius", 6, PriorKind::kNone, 64, true, SampleKind::kSpread, &Solve6ptStewenius,
       "Stewenius, Nister, Oskarsson, Astrom, OMNIVIS 2005: minimal, up to 64 solutions", 200.0},
      {"6pt-ventura", 6, PriorKind::kNone, 20, false, SampleKind::kSpread, &Solve6ptVentura,
       "Ventura, Arth, Lepetit, ICCV 2015: first order, up to 20 solutions", 20.0},
      {"5pt+1", 6, PriorKind::kNone, 10, true, SampleKind::kOnePairPlusOne, &Solve5ptPlusOne,
       "Nister, PAMI 2004: five points of one camera pair, one more for the scale", 5.0},
      {"2pt-choi", 2, PriorKind::kPlanar, 2, true, SampleKind::kOneCamera, &Solve2ptChoi,
       "Choi, Kim, 2018: a line meets the unit circle; one camera"},
      {"2pt-ackermann", 2, PriorKind::kPlanar, 3, true, SampleKind::kSpread, &Solve2ptAckermann,
       "Lee, Fraundorfer, Pollefeys, CVPR 2013: Ackermann motion"},
  };
  return catalogue;
}

const SolverInfo* FindSolver(std::string_view name) {
  for (const SolverInfo& solver : SolverCatalogue()) {
    if (name == solver.name) return &solver;
  }
  return nullptr;
}

std::string SolverNames() {
  std::string names;
  for (const SolverInfo& solver : SolverCatalogue()) {
    if (!names.empty()) names += ", ";
    names += solver.name;
  }
  return names;
}

const char* PriorKindName(PriorKind kind) { return NameOf(kPriorKindNames, kind); }

}  // namespace rigel
