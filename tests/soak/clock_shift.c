// A wall clock that can be set back for one program: LD_PRELOAD this library, and write seconds into the file that
// CLOCK_SHIFT_FILE names. Linux has no namespace for CLOCK_REALTIME, and the machine's clock is not a test's to set.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

typedef int (*ClockGettime)(clockid_t, struct timespec*);

static long shift_s(void) {
  const char* name = getenv("CLOCK_SHIFT_FILE");
  FILE* file = name ? fopen(name, "re") : NULL;
  long shift = 0;
  if (file && fscanf(file, "%ld", &shift) != 1) shift = 0;
  if (file) fclose(file);
  return shift;
}

int clock_gettime(clockid_t clock, struct timespec* now) {
  static ClockGettime next;
  if (!next) next = (ClockGettime)dlsym(RTLD_NEXT, "clock_gettime");
  const int result = next(clock, now);
  if (result == 0 && clock == CLOCK_REALTIME) now->tv_sec += shift_s();
  return result;
}

time_t time(time_t* result) {
  struct timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  if (result) *result = now.tv_sec;
  return now.tv_sec;
}
