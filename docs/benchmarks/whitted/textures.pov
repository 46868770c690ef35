// textures.toml for POV-Ray; run where scenes/images is +L's.
#include "camera.inc"
#default { finish { ambient 0.2 diffuse 1 specular 0 } }
#macro Cubes(C) pigment { checker rgb C, rgb <0.9, 0.8, 0.6> scale 0.2 } finish { ambient 0.2 diffuse 1 specular 0.4 roughness 1/50 } #end
sphere { <-1.9, 0.9, -0.4>, 0.9 Cubes(<0.75, 0.1, 0.08>) }
sphere { <0, 1, 0.3>, 1 Cubes(<0.1, 0.6, 0.15>) }
sphere { <1.9, 0.8, -0.2>, 0.8 Cubes(<0.12, 0.2, 0.75>) }
plane { y, 0 pigment { image_map { png "tiles.png" gamma srgb interpolate 2 } rotate 90*x scale 2 } }
