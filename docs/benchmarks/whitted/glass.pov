// glass.toml for POV-Ray.
#include "camera.inc"
#default { finish { ambient 0.2 diffuse 1 specular 0 } }
#declare Constants = texture {
  pigment { rgbt <1, 1, 1, 0.92> }
  finish { ambient 0 diffuse 0 reflection 0.08 }
}
sphere {
  <-1.9, 0.9, -0.4>, 0.9
  pigment { rgb 1 }
  finish { ambient 0.02 diffuse 0.1 specular 0.4 roughness 1/100 reflection 0.75 }
}
sphere {
  <0, 1, 0.3>, 1
  pigment { rgbt 1 }
  finish { ambient 0 diffuse 0 specular 0.4 roughness 1/200 reflection { 0, 1 fresnel } conserve_energy }
  interior { ior 1.5 }
}
sphere {
  <1.9, 0.8, -0.2>, 0.8
  pigment { rgb <0.2, 0.1, 0.06> }
  finish { ambient 0.2 diffuse 1 specular 0.4 roughness 1/50 reflection rgb <0.7, 0.45, 0.3> }
}
sphere { <1.2, 0.5, 1.8>, 0.5 texture { Constants } interior { ior 1.5 } }
sphere { <1.2, 0.5, 1.8>, 0.42 texture { Constants } interior { ior 1 } }
plane { y, 0 pigment { Checkerboard } }
