// mesh.toml for POV-Ray; mesh.py writes knot.inc.
#include "camera.inc"
#default { finish { ambient 0.2 diffuse 1 specular 0 } }
#include "knot.inc"
object {
  Knot
  pigment { rgb <0.75, 0.1, 0.08> }
  finish { ambient 0.2 diffuse 1 specular 0.4 roughness 1/50 }
  scale 1.6
  translate <0, 0.95, 0>
}
plane { y, 0 pigment { Checkerboard } }
