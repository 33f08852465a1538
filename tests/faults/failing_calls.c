/* Preloaded into a program under test, so that calls fail as on a full or broken disk, or when
 * memory runs out.
 *
 * ELROM_FAIL_AT=n: the n-th call that changes a regular file fails, and so do all later ones;
 * counts from 1.
 * ELROM_FAIL_WITH=errno of these failures (default ENOSPC).
 * ELROM_SHORT_AT=n: the n-th write to a regular file writes half of what it should, which is no error.
 * ELROM_FAIL_ALLOCATION=n: the n-th allocation after the start of main() fails, that one alone; children
 * that the program forks do not count. ELROM_FAIL_CHILD=n: the same, counted in each child from its fork.
 * The first of these failures is told on standard error, so that a campaign knows when there are no more
 * calls. A program that dies by a signal, or whose libraries call exit(), tells where: "[died in <file>
 * <offset> ...]", from the innermost frame outwards. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <execinfo.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

static int told_to = 2; /* standard error, also where a child has lost its own */

static void tell(void) {
  static int told;
  if (!__atomic_exchange_n(&told, 1, __ATOMIC_SEQ_CST)) syscall(SYS_write, told_to, "[call failed]\n", 14);
}

static void tell_place(void) {
  void* frames[32];
  char text[8192];
  int n = backtrace(frames, 32), used = snprintf(text, sizeof text, "[died in");
  for (int i = 1; i < n && used < (int)sizeof text - 300; ++i) {
    Dl_info place;
    if (dladdr(frames[i], &place) && place.dli_fname)
      used += snprintf(text + used, sizeof text - (size_t)used, " %.200s %#lx", place.dli_fname,
                       (unsigned long)((char*)frames[i] - (char*)place.dli_fbase) - 1);
  }
  used += snprintf(text + used, sizeof text - (size_t)used, "]\n");
  syscall(SYS_write, told_to, text, used);
}

static void on_death(int number) {
  tell_place();
  signal(number, SIG_DFL);
  raise(number);
}

static int fails_now(void) {
  static int count, at = -1;
  if (at < 0) {
    const char* text = getenv("ELROM_FAIL_AT");
    at = text ? atoi(text) : 0;
  }
  if (at <= 0 || __atomic_add_fetch(&count, 1, __ATOMIC_SEQ_CST) < at) return 0;
  tell();
  const char* with = getenv("ELROM_FAIL_WITH");
  errno = with ? atoi(with) : ENOSPC;
  return 1;
}

/* Half of a write of n bytes when it is this call's turn to be short, else n. */
static size_t shortened(size_t n) {
  static int count, at = -1;
  if (at < 0) {
    const char* text = getenv("ELROM_SHORT_AT");
    at = text ? atoi(text) : 0;
  }
  if (at <= 0 || n < 2 || __atomic_add_fetch(&count, 1, __ATOMIC_SEQ_CST) != at) return n;
  tell();
  return n / 2;
}

static int is_file(int descriptor) {
  struct stat status;
  return fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
}

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

ssize_t write(int d, const void* bytes, size_t n) {
  return is_file(d) && fails_now() ? -1 : REAL(write)(d, bytes, is_file(d) ? shortened(n) : n);
}
ssize_t writev(int d, const struct iovec* parts, int n) {
  return is_file(d) && fails_now() ? -1 : REAL(writev)(d, parts, n);
}
ssize_t pwrite(int d, const void* bytes, size_t n, off_t at) {
  return is_file(d) && fails_now() ? -1 : REAL(pwrite)(d, bytes, is_file(d) ? shortened(n) : n, at);
}
ssize_t pwrite64(int d, const void* bytes, size_t n, off64_t at) {
  return is_file(d) && fails_now() ? -1 : REAL(pwrite64)(d, bytes, is_file(d) ? shortened(n) : n, at);
}
int ftruncate(int d, off_t size) { return is_file(d) && fails_now() ? -1 : REAL(ftruncate)(d, size); }
int ftruncate64(int d, off64_t size) { return is_file(d) && fails_now() ? -1 : REAL(ftruncate64)(d, size); }
int fsync(int d) { return is_file(d) && fails_now() ? -1 : REAL(fsync)(d); }
int rename(const char* from, const char* to) { return fails_now() ? -1 : REAL(rename)(from, to); }

/* Allocations: armed when main() begins, because nobody promises anything about what runs before it. */
static int fails_at, count;

static int memory_is_out(void) {
  if (fails_at <= 0 || __atomic_add_fetch(&count, 1, __ATOMIC_SEQ_CST) != fails_at) return 0;
  tell();
  errno = ENOMEM;
  return 1;
}

extern void* __libc_malloc(size_t);
extern void* __libc_calloc(size_t, size_t);
extern void* __libc_realloc(void*, size_t);
extern void* __libc_memalign(size_t, size_t);

void* malloc(size_t n) { return memory_is_out() ? NULL : __libc_malloc(n); }
void* calloc(size_t n, size_t size) { return memory_is_out() ? NULL : __libc_calloc(n, size); }
void* realloc(void* old, size_t n) { return memory_is_out() ? NULL : __libc_realloc(old, n); }
void* aligned_alloc(size_t alignment, size_t n) {
  return memory_is_out() ? NULL : __libc_memalign(alignment, n);
}
int posix_memalign(void** block, size_t alignment, size_t n) {
  void* memory = memory_is_out() ? NULL : __libc_memalign(alignment, n);
  if (memory == NULL) return ENOMEM;
  *block = memory;
  return 0;
}

typedef int (*main_function)(int, char**, char**);
static main_function real_main;
static int number_in(const char* variable) {
  const char* text = getenv(variable);
  return text ? atoi(text) : 0;
}
static void begin_child(void) {
  count = 0;
  fails_at = number_in("ELROM_FAIL_CHILD");
}
static int armed_main(int n, char** arguments, char** environment) {
  static char stack[1 << 16]; /* a library that runs out of memory may also run out of stack */
  const stack_t own = {.ss_sp = stack, .ss_size = sizeof stack};
  struct sigaction action = {.sa_handler = on_death, .sa_flags = SA_ONSTACK};
  void* frame;
  backtrace(&frame, 1); /* loads what it needs now, not when there is no memory */
  told_to = fcntl(2, F_DUPFD_CLOEXEC, 100);
  sigaltstack(&own, NULL);
  const int deaths[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
  for (unsigned i = 0; i < sizeof deaths / sizeof *deaths; ++i) sigaction(deaths[i], &action, NULL);
  pthread_atfork(NULL, NULL, begin_child);
  fails_at = number_in("ELROM_FAIL_ALLOCATION");
  return real_main(n, arguments, environment);
}

void exit(int status) {
  tell_place();
  ((void (*)(int))dlsym(RTLD_NEXT, "exit"))(status);
  __builtin_unreachable();
}
int __libc_start_main(main_function begin, int n, char** arguments, void (*init)(void), void (*fini)(void),
                      void (*unload)(void), void* stack) {
  int (*start)(main_function, int, char**, void (*)(void), void (*)(void), void (*)(void), void*) =
      (__typeof__(start))dlsym(RTLD_NEXT, "__libc_start_main");
  real_main = begin;
  return start(armed_main, n, arguments, init, fini, unload, stack);
}
