/// Contacts of fem.solve with rigid bodies.

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <numbers>
#include <set>

#include "data/io/triangle_file.hpp"
#include "fem/contact/distance_grid.hpp"
#include "pipelines/stages/fem_problem.hpp"

namespace brachium::pipelines {
namespace {

/// One entry of `contact`.
class ContactReader {
 public:
  ContactReader(const Options& entry, Mistakes& mistakes, std::vector<data::Diagnostic>& notes)
      : entry_(entry),
        shape_(entry.text("shape")),
        owner_(fmt::format("contact `{}` (shape {})", entry.text("name"), shape_)),
        mistakes_(mistakes),
        notes_(notes) {}

  fem::Contact read() {
    fem::Contact contact;
    contact.name = entry_.text("name");
    contact.surface = entry_.text("surface");
    contact.body = body();
    contact.moves_with = entry_.maybe_text("moves_with").value_or("");
    contact.penalty_pa_per_m = entry_.maybe_number("penalty_pa_per_m").value_or(0.0);
    contact.smoothing_m = entry_.maybe_number("smoothing_m").value_or(0.0);
    contact.penetration_tolerance_m = entry_.maybe_number("penetration_tolerance_m").value_or(0.0);
    if (entry_.has("points_per_direction"))
      contact.points_per_direction = static_cast<int>(entry_.integer("points_per_direction"));
    if (contact.smoothing_m > 0.0 && contact.penetration_tolerance_m > 0.0)
      mistakes_.error(entry_, "contact-option",
                      owner_ + " has both `penetration_tolerance_m` and `smoothing_m`",
                      "multipliers take a contact that sets in at once: leave one of the two out");
    mistakes_.only_keys(entry_, keys_, owner_);
    return contact;
  }

 private:
  Eigen::Vector3d vector(const std::string& key) {
    keys_.push_back(key);
    mistakes_.need(entry_, key, owner_);
    return vector_of(entry_, key);
  }
  double number(const std::string& key) {
    keys_.push_back(key);
    mistakes_.need(entry_, key, owner_);
    return entry_.maybe_number(key).value_or(1.0);
  }

  fem::RigidShape body() {
    const std::size_t before = mistakes_.size();
    fem::RigidShape shape;
    if (shape_ == "half_space") {
      const Eigen::Vector3d point = vector("point_m");
      shape = fem::HalfSpace{point, vector("normal")};
    } else if (shape_ == "sphere") {
      const Eigen::Vector3d centre = vector("centre_m");
      shape = fem::Sphere{centre, number("radius_m")};
    } else if (shape_ == "cylinder") {
      const Eigen::Vector3d point = vector("point_m"), axis = vector("axis");
      shape = fem::Cylinder{point, axis, number("radius_m")};
    } else if (shape_ == "capsule") {
      const Eigen::Vector3d from = vector("from_m"), to = vector("to_m");
      shape = fem::Capsule{from, to, number("radius_m")};
    } else if (shape_ == "ellipsoid") {
      shape = ellipsoid();
    } else {
      shape = triangles();
    }
    if (mistakes_.size() != before) return fem::HalfSpace{};  // said already
    mistakes_.guarded(entry_, "", [&] { fem::check(shape, entry_.text("name")); });
    return shape;
  }

  fem::Ellipsoid ellipsoid() {
    fem::Ellipsoid e;
    e.centre_m = vector("centre_m");
    e.semi_axes_m = vector("semi_axes_m");
    keys_.insert(keys_.end(), {"first_axis", "second_axis"});
    if (!entry_.has("first_axis") && !entry_.has("second_axis")) return e;
    const Eigen::Vector3d first = vector("first_axis").normalized(),
                          second = vector("second_axis").normalized();
    e.axes << first, second, first.cross(second);  // fem::check says where they are not orthogonal
    return e;
  }

  fem::RigidShape triangles() {
    keys_.insert(keys_.end(), {"file", "length_unit", "place_m", "turn_axis", "turn_deg", "grid_spacing_m",
                               "grid_margin_m", "grid_smoothing_m"});
    const bool named = mistakes_.need(entry_, "file", owner_);
    const bool unit = mistakes_.need(entry_, "length_unit", owner_,
                                     "such files do not state their unit: give \"mm\", or whatever it is");
    const bool spacing = mistakes_.need(entry_, "grid_spacing_m", owner_,
                                        "a tenth of the smallest radius that matters is a start");
    const Eigen::Matrix3d turn = rotation();
    if (!named || !unit || !spacing) return fem::HalfSpace{};
    fem::TriangleBody body;
    mistakes_.guarded(entry_, owner_ + ": ", [&] {
      const io::TriangleFile file = io::read_triangles(entry_.text("file"), entry_.text("length_unit"));
      fem::TriangleMesh mesh{(turn * file.points).colwise() + vector_of(entry_, "place_m"), file.triangles};
      const double h = entry_.number("grid_spacing_m");
      body.grid = std::make_shared<const fem::DistanceGrid>(
          fem::TriangleTree(std::move(mesh)), h, entry_.maybe_number("grid_margin_m").value_or(10.0 * h),
          entry_.maybe_number("grid_smoothing_m").value_or(0.0));
      notes_.push_back(
          {data::Severity::note, "contact-grid",
           fmt::format(
               "contact `{}`: {} triangles stand as a distance field of {} x {} x {} samples, at most "
               "{:.3g} m from them",
               entry_.text("name"), file.triangles.cols(), body.grid->samples()[0], body.grid->samples()[1],
               body.grid->samples()[2], body.grid->greatest_error_m()),
           std::nullopt, ""});
    });
    return body.grid ? fem::RigidShape(body) : fem::RigidShape(fem::HalfSpace{});
  }

  Eigen::Matrix3d rotation() {
    if (!entry_.has("turn_deg") && !entry_.has("turn_axis")) return Eigen::Matrix3d::Identity();
    const std::string beside = "the two go together";
    if (!mistakes_.need(entry_, "turn_deg", owner_, beside) ||
        !mistakes_.need(entry_, "turn_axis", owner_, beside))
      return Eigen::Matrix3d::Identity();
    const Eigen::Vector3d axis = vector_of(entry_, "turn_axis");
    if (axis.norm() == 0.0)
      mistakes_.error(entry_, "zero-direction", owner_ + ": `turn_axis` has no direction");
    return Eigen::AngleAxisd(entry_.number("turn_deg") * std::numbers::pi / 180.0, axis.normalized())
        .toRotationMatrix();
  }

  const Options& entry_;
  const std::string shape_, owner_;
  Mistakes& mistakes_;
  std::vector<data::Diagnostic>& notes_;
  std::vector<std::string> keys_{"name",
                                 "surface",
                                 "shape",
                                 "moves_with",
                                 "penalty_pa_per_m",
                                 "smoothing_m",
                                 "penetration_tolerance_m",
                                 "points_per_direction"};
};

}  // namespace

std::vector<fem::Contact> fem_contacts(const Options& options, Mistakes& mistakes,
                                       std::vector<data::Diagnostic>& notes) {
  std::vector<fem::Contact> contacts;
  std::set<std::string> names;
  for (const Options& entry : options.tables("contact")) {
    if (!names.insert(entry.text("name")).second)
      mistakes.error(entry, "twice-given", fmt::format("two contacts are called `{}`", entry.text("name")));
    contacts.push_back(ContactReader(entry, mistakes, notes).read());
  }
  return contacts;
}

}  // namespace brachium::pipelines
