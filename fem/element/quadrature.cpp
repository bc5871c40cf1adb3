#include "fem/element/quadrature.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <vector>

namespace brachium::fem {
namespace {

struct GaussLine {
  std::vector<double> x, w;
};

/// Gauss-Legendre rules on [-1, 1].
const GaussLine& gauss_line(int n) {
  static const std::array<GaussLine, 5> rules{{
      {{0.0}, {2.0}},
      {{-0.57735026918962576451, 0.57735026918962576451}, {1.0, 1.0}},
      {{-0.77459666924148337704, 0.0, 0.77459666924148337704}, {5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0}},
      {{-0.86113631159405257522, -0.33998104358485626480, 0.33998104358485626480, 0.86113631159405257522},
       {0.34785484513745385737, 0.65214515486254614263, 0.65214515486254614263, 0.34785484513745385737}},
      {{-0.90617984593866399280, -0.53846931010568309104, 0.0, 0.53846931010568309104,
        0.90617984593866399280},
       {0.23692688505618908751, 0.47862867049936646804, 128.0 / 225.0, 0.47862867049936646804,
        0.23692688505618908751}},
  }};
  if (n < 1 || n > 5) throw std::logic_error("Gauss rules have 1 to 5 points a direction");
  return rules[static_cast<std::size_t>(n - 1)];
}

Quadrature tensor(int n, int dimension) {
  const GaussLine& line = gauss_line(n);
  int count = 1;
  for (int d = 0; d < dimension; ++d) count *= n;
  Quadrature rule{Eigen::MatrixXd(dimension, count), Eigen::VectorXd(count)};
  for (int q = 0; q < count; ++q) {
    double weight = 1.0;
    int rest = q;
    for (int d = 0; d < dimension; ++d) {
      const auto i = static_cast<std::size_t>(rest % n);
      rest /= n;
      rule.points(d, q) = line.x[i];
      weight *= line.w[i];
    }
    rule.weights[q] = weight;
  }
  return rule;
}

/// All permutations of barycentric coordinates, each with the same weight (a fraction of the simplex'
/// volume).
struct Orbit {
  std::vector<double> barycentric;
  double weight;
};

Quadrature symmetric(const std::vector<Orbit>& orbits, double volume) {
  const auto dimension = static_cast<Eigen::Index>(orbits.front().barycentric.size()) - 1;
  std::vector<std::vector<double>> points;
  std::vector<double> weights;
  for (const Orbit& orbit : orbits) {
    std::vector<double> b = orbit.barycentric;
    std::sort(b.begin(), b.end());
    do {
      points.push_back(b);
      weights.push_back(orbit.weight * volume);
    } while (std::next_permutation(b.begin(), b.end()));
  }
  Quadrature rule{
      Eigen::MatrixXd(dimension, static_cast<Eigen::Index>(points.size())),
      Eigen::Map<const Eigen::VectorXd>(weights.data(), static_cast<Eigen::Index>(weights.size()))};
  for (std::size_t q = 0; q < points.size(); ++q) {
    for (Eigen::Index d = 0; d < dimension; ++d)
      rule.points(d, static_cast<Eigen::Index>(q)) = points[q][static_cast<std::size_t>(d) + 1];
  }
  return rule;
}

Orbit three_equal(double a, double weight) {
  return {{1.0 - 3.0 * a, a, a, a}, weight};
}

const Quadrature& tetrahedron_degree_2() {
  static const Quadrature rule = symmetric({three_equal(0.13819660112501051518, 0.25)}, 1.0 / 6.0);
  return rule;
}

/// Walkington's 14 points, degree 5.
const Quadrature& tetrahedron_degree_5() {
  constexpr double c = 0.045503704125649649492;
  static const Quadrature rule = symmetric({three_equal(0.31088591926330060980, 0.11268792571801585080),
                                            three_equal(0.092735250310891226402, 0.073493043116361949544),
                                            {{0.5 - c, 0.5 - c, c, c}, 0.042546020777081466438}},
                                           1.0 / 6.0);
  return rule;
}

/// Keast's 24 points, degree 6.
const Quadrature& tetrahedron_degree_6() {
  constexpr double c = 0.063661001875017525299;
  static const Quadrature rule =
      symmetric({three_equal(0.21460287125915202929, 0.039922750258167938495),
                 three_equal(0.040673958534611353116, 0.010077211055320642785),
                 three_equal(0.32233789014227551034, 0.055357181543654722054),
                 {{c, c, 0.26967233145831580803, 0.60300566479164914137}, 0.048214285714285714286}},
                1.0 / 6.0);
  return rule;
}

const Quadrature& triangle_degree_2() {
  static const Quadrature rule = symmetric({{{1.0 / 6.0, 1.0 / 6.0, 2.0 / 3.0}, 1.0 / 3.0}}, 0.5);
  return rule;
}

/// Dunavant's 6 points, degree 4.
const Quadrature& triangle_degree_4() {
  constexpr double a = 0.44594849091596488632, b = 0.091576213509770743460;
  static const Quadrature rule = symmetric(
      {{{1.0 - 2.0 * a, a, a}, 0.22338158967801146570}, {{1.0 - 2.0 * b, b, b}, 0.10995174365532186764}},
      0.5);
  return rule;
}

}  // namespace

const Quadrature& cell_quadrature(Formulation formulation) {
  static const Quadrature hexahedron_2 = tensor(2, 3), hexahedron_3 = tensor(3, 3);
  switch (cell_type(formulation)) {
    case data::CellType::tet4:
      return tetrahedron_degree_2();
    case data::CellType::tet10:
      return has_bubble(formulation) ? tetrahedron_degree_6() : tetrahedron_degree_5();
    case data::CellType::hex8:
      return hexahedron_2;
    case data::CellType::hex20:
    case data::CellType::hex27:
      return hexahedron_3;
  }
  throw std::logic_error("cell type without quadrature");
}

const Quadrature& face_quadrature(data::CellType type) {
  static const Quadrature square_2 = tensor(2, 2), square_3 = tensor(3, 2);
  switch (type) {
    case data::CellType::tet4:
      return triangle_degree_2();
    case data::CellType::tet10:
      return triangle_degree_4();
    case data::CellType::hex8:
      return square_2;
    case data::CellType::hex20:
    case data::CellType::hex27:
      return square_3;
  }
  throw std::logic_error("cell type without quadrature");
}

Quadrature gauss_hexahedron(int n) {
  return tensor(n, 3);
}

}  // namespace brachium::fem
