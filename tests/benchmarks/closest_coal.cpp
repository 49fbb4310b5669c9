// Signed distances of many pairs of ellipsoids by coal, in one loop: the C face that closest.py calls.
#include <chrono>
#include <limits>
#include <vector>

#include "coal/narrowphase/narrowphase.h"
#include "coal/shape/geometric_shapes.h"

namespace {

struct Batch {
  std::vector<coal::Ellipsoid> o, f;
  std::vector<coal::Transform3s> at_o, at_f;
  std::vector<coal::Vec3s> guess;
  std::vector<coal::support_func_guess_t> hint;
};

coal::Transform3s transform(const double *pose) {
  coal::Matrix3s R;
  for (int j = 0; j < 3; j++)
    for (int i = 0; i < 3; i++) R(i, j) = pose[3 + 3 * j + i];
  return coal::Transform3s(R, coal::Vec3s(pose[0], pose[1], pose[2]));
}

}  // namespace

extern "C" {

Batch *coal_open(int n, const double *lengths) {
  Batch *b = new Batch;
  for (int i = 0; i < n; i++) {
    const double *a = lengths + 6 * i;
    b->o.emplace_back(a[0], a[1], a[2]);
    b->f.emplace_back(a[3], a[4], a[5]);
  }
  b->at_o.resize(n), b->at_f.resize(n), b->guess.assign(n, coal::Vec3s(1, 0, 0));
  b->hint.assign(n, coal::support_func_guess_t::Zero());
  return b;
}

void coal_close(Batch *b) { delete b; }

void coal_pose(Batch *b, int n, const double *pose_o, const double *pose_f) {
  for (int i = 0; i < n; i++) b->at_o[i] = transform(pose_o + 12 * i), b->at_f[i] = transform(pose_f + 12 * i);
}

// Seconds for all pairs. A warm run starts each pair from the guess that the run before left for it.
double coal_run(Batch *b, int n, int variant, double tolerance, int warm, double *d, double *normal) {
  coal::DistanceRequest request;
  request.gjk_variant = static_cast<coal::GJKVariant>(variant);
  request.gjk_tolerance = request.epa_tolerance = tolerance;
  if (tolerance < 1e-6) request.gjk_max_iterations = request.epa_max_iterations = 1000;
  request.gjk_initial_guess = coal::GJKInitialGuess::CachedGuess;
  coal::GJKSolver solver(request);
  const auto begun = std::chrono::steady_clock::now();
  for (int i = 0; i < n; i++) {
    coal::Vec3s p, q, N;
    const coal::Vec3s centres = -b->at_o[i].inverseTimes(b->at_f[i]).getTranslation();
    solver.cached_guess = warm ? b->guess[i] : centres;
    solver.support_func_cached_guess = b->hint[i];
    d[i] = solver.shapeDistance(b->o[i], b->at_o[i], b->f[i], b->at_f[i], true, p, q, N);
    b->guess[i] = solver.cached_guess, b->hint[i] = solver.support_func_cached_guess;
    for (int k = 0; k < 3; k++) normal[3 * i + k] = N[k];
  }
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
}
}
