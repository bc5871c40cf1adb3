#include "fem/linear/dense_front.hpp"

#include <Eigen/Dense>

#include "fem/linear/buffer_pool.hpp"
#include "tests/fem/linear/sparse_matrices.hpp"

namespace brachium::fem {
namespace {

// One front of the matrix `a`, eliminated: L (w + u rows), D with its subdiagonal, S.
struct Result {
  Eigen::MatrixXd l, d, schur, permutation;
  Eigen::VectorXd growth;
  int pivoted_blocks = 0;
  bool lost_column = false;
};

Result eliminate(const DenseKernels& kernels, const Eigen::MatrixXd& a, int w) {
  const int size = static_cast<int>(a.rows()), u = size - w;
  DenseFront f;
  f.pivots = w;
  f.updates = u;
  const AlignedArray packed_w = allocate_aligned(f.w_size()),
                     packed_l = allocate_aligned(DenseFront::l_size(w, u));
  std::fill_n(packed_w.get(), f.w_size(), 0.0);
  std::vector<double> schur(static_cast<std::size_t>(u) * (u + 1) / 2), d(w), e(w), growth(size),
      diagonal(size);
  std::vector<int> interchange(w);
  std::vector<char> pivoted(f.blocks());
  f.packed_w = packed_w.get();
  f.packed_l = packed_l.get();
  f.schur = schur.data();
  f.d = d.data();
  f.e = e.data();
  f.growth = growth.data();
  f.diagonal = diagonal.data();
  f.interchange = interchange.data();
  f.block_pivoted = pivoted.data();
  f.zero_pivot = 1e-13;
  for (int i = 0; i < size; ++i) {
    diagonal[i] = std::abs(a(i, i));
    for (int k = 0; k < std::min(i + 1, w); ++k) f.packed_w[f.w_offset(i) + k * kRows] = a(i, k);
  }
  for (int b = 0; b < f.blocks(); ++b) {
    kernels.eliminate_diagonal(f, b);
    // Panels one by one, last first: the order must not matter.
    for (int p = f.panels() - 1; p >= std::min(f.pivot_panels(), (b + 1) * (kBlock / kRows)); --p) {
      kernels.eliminate_rows(f, b, p, p + 1);
    }
  }
  for (int c = 0; c < u; c += kStrip) {
    for (int r = c / kChunk * kChunk; r < u; r += kChunk) kernels.schur_tile(f, c, r);
  }
  Result result;
  result.l = Eigen::MatrixXd::Zero(size, w);
  result.d = Eigen::MatrixXd::Zero(w, w);
  result.schur = Eigen::MatrixXd::Zero(u, u);
  result.permutation = Eigen::MatrixXd::Zero(size, size);
  result.growth = Eigen::Map<Eigen::VectorXd>(growth.data(), size);
  for (int i = 0; i < size; ++i) {
    const int padded = i < w ? i : f.pivot_panels() * kRows + i - w;
    for (int k = 0; k < std::min(i, w); ++k) {
      // Rows of later blocks are kept in the order that was; those of a block follow its interchanges.
      const bool same_block = i < w && i / kBlock == k / kBlock;
      const int row = i < w && !same_block ? i / kBlock * kBlock + interchange[i] : i;
      const int stored = row < w ? row : padded;
      result.l(i, k) = f.l_group(stored / kColumns)[k * kColumns + stored % kColumns];
    }
    if (i < w) result.l(i, i) = 1.0;
    result.permutation(i, i < w ? i / kBlock * kBlock + interchange[i] : i) = 1.0;
  }
  for (int k = 0; k < w; ++k) {
    result.d(k, k) = d[k];
    if (e[k] != 0.0) result.d(k + 1, k) = result.d(k, k + 1) = e[k];
  }
  for (int j = 0; j < u; ++j) {
    for (int i = j; i < u; ++i) result.schur(i, j) = result.schur(j, i) = f.schur_column(j)[i];
  }
  result.pivoted_blocks = static_cast<int>(std::count(pivoted.begin(), pivoted.end(), 1));
  result.lost_column = f.lost_column;
  return result;
}

Eigen::MatrixXd symmetric(int n, unsigned seed, double diagonal) {
  const Eigen::MatrixXd g = test::random_matrix(n, seed);
  return g + g.transpose() + diagonal * Eigen::MatrixXd::Identity(n, n);
}

// P A P' - L D L' - [0 0; 0 S + A22] = 0, where S is what the front adds to A22.
double defect(const Eigen::MatrixXd& a, const Result& r) {
  const auto w = r.l.cols(), u = a.rows() - w;
  Eigen::MatrixXd rest = r.permutation * a * r.permutation.transpose() - r.l * r.d * r.l.transpose();
  rest.bottomRightCorner(u, u) -= r.schur + a.bottomRightCorner(u, u);
  return rest.cwiseAbs().maxCoeff() / a.cwiseAbs().maxCoeff();
}

class DenseFrontShapes : public ::testing::TestWithParam<std::pair<int, int>> {};

TEST_P(DenseFrontShapes, LTimesDTimesLTransposedIsTheMatrix) {
  const auto [w, u] = GetParam();
  const Eigen::MatrixXd definite = symmetric(w + u, 3, 4.0 * std::sqrt(w + u + 1.0));
  const Eigen::MatrixXd indefinite = symmetric(w + u, 4, 0.0);
  for (const DenseKernels* kernels : {&dense_kernels_portable(), &dense_kernels()}) {
    const Result easy = eliminate(*kernels, definite, w);
    EXPECT_LT(defect(definite, easy), 1e-14) << kernels->name;
    EXPECT_EQ(easy.pivoted_blocks, 0);
    const Result hard = eliminate(*kernels, indefinite, w);
    // Interchanges stay inside blocks of 48: growth is bounded by what is measured.
    EXPECT_LT(defect(indefinite, hard), 1e-14 * hard.growth.maxCoeff()) << kernels->name;
  }
}

TEST_P(DenseFrontShapes, GrowthIsTheDiagonalOfTheProductOfSizes) {
  const auto [w, u] = GetParam();
  const Eigen::MatrixXd a = symmetric(w + u, 4, 0.0);
  const Result r = eliminate(dense_kernels(), a, w);
  const Eigen::VectorXd g =
      r.permutation.transpose() * (r.l.cwiseAbs() * r.d.cwiseAbs() * r.l.cwiseAbs().transpose()).diagonal();
  EXPECT_LT((g - r.growth).cwiseAbs().maxCoeff(), 1e-12 * g.maxCoeff());
}

INSTANTIATE_TEST_SUITE_P(PivotsAndUpdates, DenseFrontShapes,
                         ::testing::Values(std::pair(1, 0), std::pair(1, 1), std::pair(3, 5),
                                           std::pair(4, 12), std::pair(12, 24), std::pair(13, 37),
                                           std::pair(47, 10), std::pair(48, 0), std::pair(49, 100),
                                           std::pair(131, 205), std::pair(300, 97)),
                         [](const auto& named) {
                           return std::to_string(named.param.first) + "_" +
                                  std::to_string(named.param.second);
                         });

TEST(DenseFront, VanishingPivotWithAColumnIsReportedLost) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Identity(3, 3);
  a(0, 0) = 0.0;
  a(2, 0) = a(0, 2) = 1.0;
  EXPECT_TRUE(eliminate(dense_kernels(), a, 2).lost_column);
  a(2, 0) = a(0, 2) = 0.0;
  EXPECT_FALSE(eliminate(dense_kernels(), a, 2).lost_column);
}

}  // namespace
}  // namespace brachium::fem
