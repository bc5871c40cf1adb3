#pragma once
/// The stress-free shape of a body whose loaded shape is known (an image shows muscles in situ).
///
///   find X with x(X) = x*,     X <- X + e - (DX + DE) g,     g = argmin |e - DE g|,     e = x* - x(X)
///
/// | symbol | meaning                                                                    |
/// |--------|----------------------------------------------------------------------------|
/// | X      | stress-free points; those that conditions hold stay where `start` has them |
/// | x(X)   | equilibrium at the end of the programme of the problem that is made of X   |
/// | x*     | the loaded shape                                                           |
/// | DX, DE | changes of X and e over the last iterations                                |
///
/// Stress and stretch of the loaded shape follow from it; what is held must be given as it is when free,
/// since nothing else says how far it was pulled. (Sellier
/// 2011, doi:10.1016/j.jfluidstructs.2011.08.002, with g = 0; Anderson 1965, doi:10.1145/321296.321305, of g.
/// Without it soft modes, such as a slender body's bending, come at a crawl.)

#include <functional>
#include <vector>

#include "fem/solve/solve.hpp"

namespace brachium::fem {

struct StressFreeOptions {
  double tolerance_m = 1e-7;  ///< greatest distance of a free point from its place in the loaded shape
  int max_iterations = 60;
  SolveOptions solve;
};

struct StressFreeShape {
  data::Mesh mesh;              ///< stress-free
  SolveState loaded;            ///< its equilibrium at the end of the programme
  std::vector<double> error_m;  ///< greatest distance, by iteration
  bool converged = false;
  std::string reason;  ///< why not
};

/// `loaded_m`: x*, columns as the mesh's points. `start`: connectivity, surfaces, and a first guess of X.
/// `make`: the problem of a stress-free mesh, its fibres included. Throws InputError("in-situ-shape") where
/// the number of points differs, or where held points do not arrive at x*.
StressFreeShape stress_free_shape(const Eigen::Matrix3Xd& loaded_m, data::Mesh start,
                                  const std::function<Problem(std::shared_ptr<const data::Mesh>)>& make,
                                  const StressFreeOptions& options = {});

}  // namespace brachium::fem
