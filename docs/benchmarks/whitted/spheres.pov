// spheres.toml for POV-Ray.
#include "camera.inc"
#default { finish { ambient 0.2 diffuse 1 specular 0 } }
#macro Shiny(C) pigment { rgb C } finish { ambient 0.2 diffuse 1 specular 0.4 roughness 1/50 } #end
sphere { <-1.9, 0.9, -0.4>, 0.9 Shiny(<0.75, 0.1, 0.08>) }
sphere { <0, 1, 0.3>, 1 Shiny(<0.1, 0.6, 0.15>) }
sphere { <1.9, 0.8, -0.2>, 0.8 Shiny(<0.12, 0.2, 0.75>) }
plane { y, 0 pigment { Checkerboard } }
