#include "pipelines/stages/fem_options.hpp"

#include "fem/formulation.hpp"
#include "pipelines/stages/fem_option_kinds.hpp"

namespace brachium::pipelines {
namespace {

OptionSpec material_option() {
  const Bounds positive = above(0.0), any = at_least(0.0);
  return list_option(
      "material",
      {optional_texts("regions",
                      "regions of the mesh, by name or pattern; absent: all that no other entry names"),
       optional_text("set",
                     "named parameters of the muscle-tendon law (sprenger, ...); parameters given beside "
                     "replace its own"),
       optional_choice(
           "law", {"muscle_tendon", "neo_hooke", "mooney_rivlin", "fung_guccione", "blemker_muscle"},
           "law, all of whose parameters are then given; absent: muscle_tendon where there is a `set`"),
       optional_flag("incompressible",
                     "exactly incompressible (by augmented Lagrange where the pressure is condensed)"),
       optional_number("bulk_modulus_pa", "Pa", positive,
                       "resistance to change of volume; either this or `incompressible = true`"),
       choice_option("volumetric_law", "quadratic", {"quadratic", "logarithmic"},
                     "k/2 (J - 1)^2 or k/2 (ln J)^2"),
       optional_text("muscle_set", "muscle_tendon: named parameters of the muscle tissue"),
       optional_text("tendon_set", "muscle_tendon: named parameters of the tendon tissue"),
       optional_text(
           "force_length_set",
           "muscle_tendon: named widths and exponents of the force-length curve; with `optimal_stretch`"),
       optional_number("muscle_c1_pa", "Pa", any, "muscle_tendon"),
       optional_number("muscle_c2_pa", "Pa", any, "muscle_tendon"),
       optional_number("muscle_c3_pa", "Pa", any, "muscle_tendon"),
       optional_number("muscle_c4", "1", positive, "muscle_tendon"),
       optional_number("tendon_c1_pa", "Pa", any,
                       "muscle_tendon; tissue that is all muscle may leave the tendon's out"),
       optional_number("tendon_c2_pa", "Pa", any, "muscle_tendon"),
       optional_number("tendon_c3_pa", "Pa", any, "muscle_tendon"),
       optional_number("tendon_c4", "1", positive, "muscle_tendon"),
       optional_number("max_stress_pa", "Pa", any, "muscle_tendon, blemker_muscle: sigma_max"),
       optional_number("optimal_stretch", "1", positive,
                       "muscle_tendon, blemker_muscle: stretch of the largest active stress"),
       optional_number("ascending_width", "1", positive, "muscle_tendon: dW below the optimum"),
       optional_number("ascending_exponent", "1", positive, "muscle_tendon: nu below the optimum"),
       optional_number("descending_width", "1", positive, "muscle_tendon: dW above the optimum"),
       optional_number("descending_exponent", "1", positive, "muscle_tendon: nu above the optimum"),
       optional_choice(
           "blending", {"energies", "parameters"},
           "muscle_tendon: how muscle and tendon mix where 0 < gamma_M < 1; energies where absent"),
       optional_choice("active_stress", {"nominal", "cauchy"},
                       "muscle_tendon: what sigma_max is; nominal where absent"),
       optional_number("max_rate_per_s", "1/s", positive,
                       "muscle_tendon: largest rate of shortening, optimal lengths a second; with it the "
                       "active stress depends on the rate"),
       optional_number("force_velocity_curvature", "1", positive, "muscle_tendon: Hill's a/F0"),
       optional_number("eccentric_force", "1", above(1.0),
                       "muscle_tendon: largest force when lengthening over the isometric one"),
       optional_number("shear_modulus_pa", "Pa", positive, "neo_hooke"),
       optional_number("c10_pa", "Pa", any, "mooney_rivlin"),
       optional_number("c01_pa", "Pa", any, "mooney_rivlin"),
       optional_number("stiffness_pa", "Pa", positive, "fung_guccione: C"),
       optional_number("bf", "1", positive, "fung_guccione"),
       optional_number("bt", "1", positive, "fung_guccione"),
       optional_number("bfs", "1", positive, "fung_guccione"),
       optional_flag(
           "isochoric",
           "neo_hooke, mooney_rivlin, fung_guccione: written in the deviatoric part of the deformation"),
       optional_number("along_fibre_shear_pa", "Pa", any, "blemker_muscle: G1"),
       optional_number("cross_fibre_shear_pa", "Pa", positive, "blemker_muscle: G2"),
       optional_number("passive_coefficient", "1", any, "blemker_muscle: P1"),
       optional_number("passive_exponent", "1", positive, "blemker_muscle: P2"),
       optional_number("straightening_stretch", "1", positive,
                       "blemker_muscle: lambda_max, above which passive stress is linear")},
      "materials of named regions");
}

OptionSpec fibre_option() {
  return list_option(
      "fibre",
      {optional_texts("regions", "regions of the mesh, by name or pattern; absent: all"),
       required_choice("kind", {"constant", "mesh_field", "mesh_lines", "harmonic"},
                       "one direction; vectors that the mesh brings along; along the cells' own lines; "
                       "gradient of a harmonic function from origin to insertion"),
       vector_option("direction", "1", "constant: any length but zero"),
       optional_text("field", "mesh_field: its name"),
       optional_choice("axis", {"first", "second", "third"}, "mesh_lines: which of the cells' axes"),
       optional_text("origin", "harmonic: surface at which the function is 0"),
       optional_text("insertion", "harmonic: surface at which it is 1"),
       optional_number("pennation_deg", "deg", between(-90.0, 90.0),
                       "harmonic: rotation of the fibres about `pennation_axis`"),
       vector_option("pennation_axis", "1", "harmonic: axis of that rotation")},
      "fibre directions of regions; every region whose law has fibres needs one");
}

OptionSpec blend_option() {
  return list_option("blend",
                     {required_choice("of", {"muscle", "soft_tissue"},
                                      "gamma_M: 1 muscle, 0 tendon; gamma_ST: 1 tissue without fibres"),
                      optional_texts("regions", "regions of the mesh, by name or pattern; absent: all"),
                      optional_number("value", "1", between(0.0, 1.0), "one value"),
                      optional_text("field", "or a field that the mesh brings along")},
                     "how tissues blend; without an entry a region is all muscle and no soft tissue");
}

OptionSpec boundary_option() {
  OptionSpec components = optional_texts("components", "fixed: which of x, y, z; absent: all");
  components.allowed = {"x", "y", "z"};
  return list_option(
      "boundary",
      {required_text("name", "unique; phases refer to it"),
       optional_text("surface",
                     "surface or node set of the mesh; not for `weight`, optional for `rigid_motion`"),
       required_choice(
           "kind",
           {"fixed", "displacement", "rigid_motion", "symmetry", "traction", "force", "pressure", "weight"},
           "fixed: no displacement; displacement: prescribed components; rigid_motion: the surface moves as "
           "a rigid body (without a surface: only the bodies of `contact` that move with it do); symmetry: "
           "none along the surface's normal; "
           "traction: dead load per reference area; force: dead load in all; pressure: follows the deformed "
           "normal; weight: dead load per reference volume"),
       components, optional_number("x_m", "m", {}, "displacement: along x at amplitude 1; absent: free"),
       optional_number("y_m", "m", {}, "displacement: along y"),
       optional_number("z_m", "m", {}, "displacement: along z"),
       vector_option("translation_m", "m", "rigid_motion: at amplitude 1"),
       vector_option("centre_m", "m", "rigid_motion: a point on the axis of rotation"),
       vector_option("axis", "1", "rigid_motion: axis of rotation"),
       optional_number("angle_deg", "deg", {}, "rigid_motion: at amplitude 1"),
       vector_option("traction_pa", "Pa", "traction: at amplitude 1"),
       vector_option("force_n", "N", "force: at amplitude 1"),
       optional_number("pressure_pa", "Pa", {}, "pressure: at amplitude 1, against the outward normal"),
       vector_option("force_n_m3", "N/m3", "weight: at amplitude 1")},
      "what holds and loads the body; values are those at amplitude 1, which the phases move");
}

OptionSpec points_option() {
  OptionSpec points = optional_number("points_per_direction", "1", between(1.0, 5.0),
                                      "integration points on each side of a face; absent: 4");
  points.type = OptionType::integer;
  return points;
}

OptionSpec contact_option() {
  OptionSpec file = optional_text("file", "triangles: closed surface, .stl or .obj, normals outward");
  file.is_file = true;
  return list_option(
      "contact",
      {required_text("name", "unique"),
       required_text("surface", "surface of the mesh that may touch the body"),
       required_choice("shape", {"half_space", "sphere", "cylinder", "capsule", "ellipsoid", "triangles"},
                       "rigid body; a cylinder has no ends, a capsule ends in half spheres"),
       vector_option("point_m", "m", "half_space: a point of its plane; cylinder: a point of its axis"),
       vector_option("normal", "1", "half_space: outward, towards the muscle"),
       vector_option("centre_m", "m", "sphere, ellipsoid"),
       optional_number("radius_m", "m", above(0.0), "sphere, cylinder, capsule"),
       vector_option("axis", "1", "cylinder: its direction"),
       vector_option("from_m", "m", "capsule: one end of its axis"),
       vector_option("to_m", "m", "capsule: the other"),
       vector_option("semi_axes_m", "m", "ellipsoid"),
       vector_option("first_axis", "1", "ellipsoid: direction of the first semi-axis; absent: x"),
       vector_option("second_axis", "1", "ellipsoid: of the second, at right angles to it; absent: y"),
       file,
       optional_text("length_unit", "triangles: unit of the file's coordinates"),
       optional_number("turn_deg", "deg", {},
                       "triangles: turned about `turn_axis` through the file's origin"),
       vector_option("turn_axis", "1", "triangles: right hand"),
       vector_option("place_m", "m", "triangles: where the file's origin comes to lie; absent: it stays"),
       optional_number(
           "grid_spacing_m", "m", above(0.0),
           "triangles: spacing of the distance field that stands for them; rounds edges by about as much"),
       optional_number("grid_margin_m", "m", at_least(0.0),
                       "triangles: how far the field reaches beyond them; absent: ten spacings"),
       optional_number("grid_smoothing_m", "m", at_least(0.0),
                       "triangles: width of a Gaussian that rounds facets"),
       optional_text("moves_with",
                     "condition of kind rigid_motion whose motion the body shares; absent: it rests"),
       optional_number("penalty_pa_per_m", "Pa/m", above(0.0),
                       "pressure by penetration; absent: ten times the stiffness of the material over the "
                       "size of a cell"),
       optional_number(
           "penetration_tolerance_m", "m", above(0.0),
           "augmented Lagrange until no point is deeper than this; absent: what the penalty leaves"),
       optional_number("smoothing_m", "m", above(0.0),
                       "width over which the pressure sets in; not with `penetration_tolerance_m`"),
       points_option()},
      "frictionless contact with rigid bodies. A contact holds nothing before it is closed: the body must be "
      "supported "
      "without it");
}

OptionSpec phase_option() {
  OptionSpec activation = map_option("activation", between(0.0, 1.0),
                                     "activation at the phase's end, by region { muscle = 0.5 }, or one "
                                     "number for every region with an active law; others keep theirs");
  return list_option(
      "phase",
      {required_text("name", "unique"),
       map_option("amplitude", {},
                  "amplitudes of boundary conditions at the phase's end, { pull = 1.0 }; others keep theirs"),
       activation, texts_option("release", {}, "conditions whose forces fade to zero over the phase"),
       cells_option("steps", 4, "load steps to begin with; more are made where needed"),
       number_option("duration_s", "s", 1.0, above(0.0), "time scale; matters to rate-dependent laws only")},
      "the load programme: phases one after the other, linear in between");
}

OptionSpec output_option() {
  return list_option(
      "output",
      {required_text("name", "becomes the start of its columns"),
       required_choice(
           "kind",
           {"reaction", "stress_resultant", "contact", "volume", "fibre_stretch", "fibre_stress",
            "active_stress", "von_mises", "pressure", "jacobian", "section", "displacement", "point"},
           "reaction: force and moment that a surface's nodes exert on the surroundings; stress_resultant: "
           "the same from stresses; contact: what a rigid body exerts on the surface in contact with it; "
           "volume: of "
           "regions; fibre_stretch to jacobian: "
           "volume-weighted mean, smallest and largest value; section: area and radii (and thickness) of a "
           "cross-section that moves with the material; displacement: of a material point; point: fibre "
           "stretch and stresses there"),
       optional_text("surface", "reaction, stress_resultant"), optional_text("contact", "contact: its name"),
       vector_option(
           "point_m", "m",
           "moment about this point; section: a point of the plane; displacement, point: the point; all "
           "in the undeformed body"),
       optional_texts("regions", "by name or pattern; absent: all"),
       vector_option("normal", "1", "section: of the plane, undeformed"),
       vector_option("direction", "1", "section: with it, also the deformed extent along this direction")},
      "wanted quantities, one row per accepted state in the table `quantities`");
}

}  // namespace

OptionSpec solver_option() {
  const fem::SolveOptions d;
  OptionSpec solver = table_option(
      "solver",
      {number_option("relative_residual", "1", d.relative_residual, above(0.0),
                     "forces out of balance over internal forces"),
       number_option("relative_step", "1", d.relative_step, above(0.0), "last change over the displacement"),
       integer_option("max_iterations", d.max_iterations, between(1, 1000),
                      "iterations of a load step before it is cut"),
       flag_option("predictor", d.predictor, "start each step from the tangent of the last"),
       flag_option("chord", d.chord, "use a factor again while it converges well"),
       number_option("smallest_step", "1", d.smallest_step, above(0.0),
                     "fraction of a phase; below it the solve fails or relaxes"),
       number_option("largest_step", "1", d.largest_step, above(0.0), "fraction of a phase"),
       flag_option("grow_steps", d.grow_steps, "make steps larger where they converge fast"),
       number_option("volume_tolerance", "1", d.volume_tolerance, above(0.0),
                     "on |J - 1| of incompressible regions with condensed pressure"),
       integer_option("max_augmentations", d.max_augmentations, between(1, 1000), "outer iterations for it"),
       number_option("penalty_pa", "Pa", d.penalty_pa, at_least(0.0),
                     "bulk modulus of that iteration; 0: chosen from the materials"),
       choice_option("stability", d.stability, {"every_state", "phase_ends", "off"},
                     "which states are tested for negative modes of the tangent"),
       choice_option("on_instability", d.on_instability, {"relax", "report", "fail"},
                     "relax: go on to a stable state by a viscosity that vanishes"),
       text_option("linear_solver", d.linear_solver, "fem/linear"),
       choice_option("ordering", d.ordering, {"automatic", "metis", "amd"}, "of the unknowns"),
       flag_option("deterministic", d.deterministic,
                   "the same result to the last bit for any number of threads")},
      "how it is solved");
  return solver;
}

std::vector<OptionSpec> fem_option_specs() {
  return {fem_mesh_option(),
          choice_option("element", "q2_p1_discontinuous", fem::formulation_names(),
                        "finite element: displacement and pressure spaces"),
          material_option(),
          fibre_option(),
          blend_option(),
          boundary_option(),
          contact_option(),
          phase_option(),
          output_option(),
          choice_option("save_fields", "all", {"all", "phase_ends", "last", "none"},
                        "states whose fields are written for ParaView (VTKHDF, XDMF)"),
          solver_option()};
}

fem::SolveOptions solve_options(const Options& options, std::size_t threads) {
  fem::SolveOptions out;
  out.threads = threads;
  const Options* given = options.maybe_table("solver");
  if (!given) return out;
  out.relative_residual = given->number("relative_residual");
  out.relative_step = given->number("relative_step");
  out.max_iterations = static_cast<int>(given->integer("max_iterations"));
  out.predictor = given->boolean("predictor");
  out.chord = given->boolean("chord");
  out.smallest_step = given->number("smallest_step");
  out.largest_step = given->number("largest_step");
  out.grow_steps = given->boolean("grow_steps");
  out.volume_tolerance = given->number("volume_tolerance");
  out.max_augmentations = static_cast<int>(given->integer("max_augmentations"));
  out.penalty_pa = given->number("penalty_pa");
  out.stability = given->text("stability");
  out.on_instability = given->text("on_instability");
  out.linear_solver = given->text("linear_solver");
  out.ordering = given->text("ordering");
  out.deterministic = given->boolean("deterministic");
  return out;
}

}  // namespace brachium::pipelines
