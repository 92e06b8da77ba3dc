#pragma once
// Small scenes that hold what a checkpoint must not lose. SOURCE stands for the source folder.
#include <fmt/core.h>

#include <map>
#include <string>

namespace regression {

/// Spheres and clumps fall in a channel that repeats itself along x, under a plate with a servo: friction, rolling
/// springs, bonds that break, a wall that leaves, damping in the first stage.
inline std::string grains_scene() {
  std::string text = R"(title = "grains"
[time]
dem_fraction = 0.2
[grains]
material = { young_modulus = "20 MPa", poisson_ratio = 0.2, density = 2700 }
friction = 0.5
restitution = 0.6
rolling = "type_c"
rolling_friction = 0.1
rolling_damping = 0.3
[[grains.periodic]]
axis = "x"
lower = 0.0
upper = 0.2
[[grains.shape]]
name = "stone"
file = "SOURCE/meshes/ballast/stone1.clump10.csv"
)";
  int number = 0;
  for (int layer = 0; layer < 3; ++layer)
    for (int row = 0; row < 2; ++row)
      for (int column = 0; column < 4; ++column, ++number) {
        const double x = 0.025 + 0.05 * column + 0.004 * layer, y = 0.03 + 0.06 * row + 0.003 * layer;
        text += fmt::format("[[grain]]\nposition = [{}, {}, {}]\nvelocity = [{}, 0.1, 0.0]\n", x, y,
                            0.03 + 0.05 * layer, 0.2 * layer - 0.1 * row);
        if (layer == 1 && column % 2)
          text += "shape = \"stone\"\nsize = \"30 mm\"\norientation = [\"40 deg\", 0.0, \"70 deg\"]\n";
        else
          text += fmt::format("radius = {}\n", 0.02 + 0.001 * column);
      }
  for (const int side : {0, 1})
    text += fmt::format("[[wall]]\nname = \"side{}\"\nplane = {{ point = [0, {}, 0], normal = [0, {}, 0] }}\n", side,
                        0.12 * side, 1 - 2 * side);
  return text + R"(
[[bond]]
first = 16
second = 17
normal_stiffness = "1 GPa/m"
shear_stiffness = "0.5 GPa/m"
tensile_strength = "5 kPa"
shear_strength = "5 kPa"
[[bond]]
first = 18
second = 19
normal_stiffness = "1 GPa/m"
shear_stiffness = "0.5 GPa/m"
tensile_strength = "500 MPa"
shear_strength = "500 MPa"
[[wall]]
name = "floor"
plane = { point = [0, 0, 0], normal = [0, 0, 1] }
[[wall]]
name = "gate"
plane = { point = [0, 0, 0.005], normal = [0, 0, 1] }
removed_at = "press"
[[wall]]
name = "plate"
mesh = "SOURCE/meshes/plate.geo"
mesh_parameters = { length = 0.4, width = 0.12 }
translation = [0.1, 0.06, 0.19]
body = { mass = "1 kg", moves = ["z"], damping = "10 1/s" }
[[wall.load]]
kind = "force"
direction = [0.0, 0.0, -1.0]
history = { kind = "ramp", value = "60 N", duration = "30 ms" }
[[stage]]
name = "fall"
duration = "30 ms"
grain_damping = "2 1/s"
[[stage]]
name = "press"
duration = "60 ms"
measure = true
[[probe]]
name = "plate"
kind = "wall_displacement"
wall = "plate"
component = "z"
[[probe]]
name = "kinetic"
kind = "kinetic_energy"
[[probe]]
name = "broken"
kind = "broken_bonds"
[[probe]]
name = "stone"
kind = "grain_position"
point = [0.1, 0.06, 0.1]
component = "y"
[[result]]
name = "swing"
probe = "plate"
take = "range"
unit = "mm"
[[result]]
name = "mean"
probe = "kinetic"
take = "mean"
unit = "J"
[output]
interval = "20 ms"
probe_interval = "0.7 ms"
contacts = true
)";
}

/// Two beams that swing, with what their laws need beside the elastic constants.
inline std::string beams_scene(const std::string& head, const std::map<std::string, std::string>& laws, bool shaken) {
  const std::string motion =
      "[[body.motion]]\nname = \"shaken_{}\"\nkind = \"displacement\"\ngroup = \"x_max\"\n"
      "along = [\"y\"]\nhistory = {{ kind = \"table\", times = [0.0, 0.05, 0.15, 0.2], values = [\"0 mm\", \"1 mm\", "
      "\"-1 mm\", \"0 mm\"] }}\n";
  std::string text = "title = \"beams\"\n" + head;
  for (const auto& [name, law] : laws)
    text += fmt::format(R"([[body]]
name = "{0}"
mesh = "SOURCE/meshes/box.geo"
mesh_parameters = {{ length = 1.0, width = 0.2, height = 0.2, cells_x = 8, cells_y = 2, cells_z = 2 }}
translation = [0.0, {2}, 0.0]
element = "hex8"
damping = "3 1/s"
[[body.material]]
group = "solid"
{1}
young_modulus = "400 MPa"
poisson_ratio = 0.2
density = "2000 kg/m3"
[[body.support]]
group = "x_min"
fix = ["x", "y", "z"]
{3}[[body.load]]
name = "tip_{0}"
group = "x_max"
kind = "face_total"
direction = [0.0, 0.0, -1.0]
history = {{ kind = "step", value = "500 N" }}
[[probe]]
name = "tip_{0}"
kind = "displacement"
body = "{0}"
group = "x_max"
component = "z"
[[result]]
name = "frequency_{0}"
probe = "tip_{0}"
take = "frequency"
unit = "Hz"
)",
                        name, law, 0.5 * static_cast<double>(name.size()),
                        shaken ? fmt::format(fmt::runtime(motion), name) : "");
  return text + R"(
[[stage]]
name = "swing"
duration = "0.2 s"
measure = true
[output]
interval = "50 ms"
probe_interval = "2 ms"
)";
}

/// Kelvin-Voigt and Drucker-Prager: laws that keep something; shaken at their tips.
inline std::string remembering_beams(const std::string& head = "") {
  return beams_scene(head,
                     {{"viscous", "law = \"kelvin_voigt\"\nshear_viscosity = \"1e5 Pa s\""},
                      {"yielding", "law = \"drucker_prager\"\ncohesion = \"20 kPa\"\nfriction_angle = \"30 deg\""}},
                     true);
}

/// Spheres on a plate that bends: both sides, coupled.
inline std::string coupled_scene() {
  std::string text = R"(title = "coupled"
[grains]
material = { young_modulus = "100 MPa", poisson_ratio = 0.2, density = 2700 }
friction = 0.4
restitution = 0.5
)";
  for (int k = 0; k < 12; ++k)
    text += fmt::format("[[grain]]\nposition = [{}, {}, {}]\nradius = 0.02\n", 0.08 + 0.05 * (k % 6) + 0.002 * (k / 6),
                        0.003 * (k % 4), 0.046 + 0.045 * (k / 6));
  return text + R"(
[[body]]
name = "plate"
mesh = "SOURCE/meshes/box.geo"
mesh_parameters = { length = 0.4, width = 0.2, height = 0.05, cells_x = 8, cells_y = 4, cells_z = 1 }
element = "hex8"
skin = ["z_max"]
[[body.material]]
group = "solid"
law = "kelvin_voigt"
shear_viscosity = "100 Pa s"
young_modulus = "50 MPa"
poisson_ratio = 0.2
density = "2000 kg/m3"
[[body.support]]
group = "x_min"
fix = ["x", "y", "z"]
[[body.support]]
group = "x_max"
fix = ["x", "y", "z"]
[[stage]]
name = "settle"
duration = "10 ms"
hold = ["plate"]
[[stage]]
name = "free"
duration = "20 ms"
measure = true
[[probe]]
name = "middle"
kind = "displacement"
body = "plate"
point = [0.2, 0.0, 0.025]
component = "z"
[[probe]]
name = "on_plate"
kind = "contact_force"
body = "plate"
component = "z"
[[result]]
name = "deepest"
probe = "middle"
take = "min"
unit = "mm"
[output]
interval = "6 ms"
probe_interval = "0.5 ms"
)";
}

/// A heap of spheres that slides at 6 m/s over a long strip: past where all of its parts have begun.
inline std::string travelling_scene() {
  std::string text = R"(title = "travelling"
[grains]
material = { young_modulus = "100 MPa", poisson_ratio = 0.2, density = 2700 }
friction = 0.1
restitution = 0.5
)";
  for (int k = 0; k < 48; ++k)
    text += fmt::format("[[grain]]\nposition = [{}, {}, {}]\nradius = 0.02\nvelocity = [6.0, 0.0, 0.0]\n",
                        0.1 + 0.045 * (k % 12) + 0.003 * (k / 24), -0.024 + 0.048 * (k / 12 % 2) + 0.001 * (k % 3),
                        0.0451 + 0.041 * (k / 24));
  return text + R"(
[[body]]
name = "strip"
mesh = "SOURCE/meshes/box.geo"
mesh_parameters = { length = 3.2, width = 0.2, height = 0.05, cells_x = 64, cells_y = 2, cells_z = 1 }
element = "hex8"
skin = ["z_max"]
[[body.material]]
group = "solid"
young_modulus = "50 MPa"
poisson_ratio = 0.2
density = "2000 kg/m3"
[[body.support]]
group = "z_min"
fix = ["x", "y", "z"]
[[stage]]
name = "travel"
duration = "0.15 s"
measure = true
[[probe]]
name = "place"
kind = "grain_position"
grain = 5
component = "x"
[[probe]]
name = "on_strip"
kind = "contact_force"
body = "strip"
component = "z"
[[result]]
name = "place"
probe = "place"
[output]
interval = "50 ms"
probe_interval = "2 ms"
)";
}

inline std::string long_grains_scene() {
  std::string text = grains_scene();
  const std::string end = "duration = \"60 ms\"";
  return text.replace(text.find(end), end.size(), "duration = \"400 ms\"");
}

/// A grain slides over the seam of a slab that repeats itself along x: its skin goes on beyond the faces.
inline std::string seam_scene() {
  return R"(title = "seam"
[grains]
material = { young_modulus = "1 GPa", poisson_ratio = 0.2, density = 2600 }
friction = 0.3
restitution = 0.3
[[grains.periodic]]
axis = "x"
lower = 0.0
upper = 0.4
[[grain]]
position = [0.398, 0.02, 0.069996]
radius = 0.02
velocity = [0.4, 0.05, 0.0]
[[body]]
name = "slab"
mesh = "SOURCE/meshes/box.geo"
mesh_parameters = { length = 0.4, width = 0.2, height = 0.1, cells_x = 8, cells_y = 4, cells_z = 2 }
element = "hex8_bbar"
gravity = false
skin = ["z_max"]
[[body.material]]
young_modulus = "1 GPa"
poisson_ratio = 0.2
density = 2000
[[body.support]]
group = "z_min"
fix = ["x", "y", "z"]
[[body.periodic]]
first = "x_min"
second = "x_max"
[[stage]]
name = "settle"
duration = "4 ms"
[[stage]]
name = "slide"
duration = "4 ms"
measure = true
[[probe]]
name = "height"
kind = "grain_position"
grain = 0
component = "z"
[[result]]
name = "height"
probe = "height"
[output]
interval = "2 ms"
probe_interval = "0.1 ms"
)";
}

}  // namespace regression
