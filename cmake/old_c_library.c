// What GCC's static C++ library takes from C libraries newer than 2.31; tools/make_sysroot.sh links it into wheels.
#include <stdlib.h>
#include <sys/random.h>

// Whether the process has one thread alone: never, as far as we know, so that counters are always atomic.
char __libc_single_threaded = 0;

unsigned arc4random(void) {
  unsigned bits = 0;
  if (getrandom(&bits, sizeof bits, 0) != sizeof bits) abort();
  return bits;
}
