/* The C interface of collisions as a caller without CMake builds it:
 * cc call_collision.c $(pkg-config --cflags --libs elrom-collision). */
#include <elrom/particle/collision.h>
#include <stdio.h>

int main(void) {
  elrom_collision* none = elrom_collision_open("no such file");
  printf("%s\n", elrom_collision_last_error());
  return none == NULL ? 0 : 1;
}
