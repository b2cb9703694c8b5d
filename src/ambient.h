/* The light that built-in callbacks add to that of the lights: from above. */
#ifndef SRC_AMBIENT_H
#define SRC_AMBIENT_H

/* Of one fragment, or of a vector of them. */
#define SHB_AMBIENT_LIGHT(shading_y) (0.04f * (1 + (shading_y)))

#endif
