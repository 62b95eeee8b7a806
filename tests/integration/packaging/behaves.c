/* Checks that every call of the library leaves its process unchanged: no output, no threads, equal
 * locale, folder, rounding and signal handlers, and the library can be unloaded and loaded again.
 * usage: behaves LIBRARY GRAPH */
#define _GNU_SOURCE
#include <dermis/dermis.h>
#include <dirent.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <fenv.h>
#include <locale.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { LOADS = 100, SIGNALS = 32 };

typedef struct library {
  void* handle;
  dermis_result(DERMIS_CALL* validate)(const dermis_source*, dermis_report*);
  void(DERMIS_CALL* destroy)(dermis_report);
} library;

static int failures;
static void expect(int holds, const char* what) {
  if (holds) return;
  ++failures;
  fprintf(stderr, "not so: %s\n", what);
}

static int threads(void) {
  int count = 0;
  DIR* folder = opendir("/proc/self/task");
  while (folder != NULL && readdir(folder) != NULL)
    ++count;
  if (folder != NULL) closedir(folder);
  return count;
}

static library load(const char* path) {
  library made;
  void* function;
  made.handle = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  if (made.handle == NULL) {
    fprintf(stderr, "%s\n", dlerror());
    exit(1);
  }
  function = dlsym(made.handle, "dermis_validate");
  memcpy(&made.validate, &function, sizeof function);
  function = dlsym(made.handle, "dermis_report_destroy");
  memcpy(&made.destroy, &function, sizeof function);
  return made;
}

static void use(const library* loaded, const char* text, size_t length, dermis_result expected) {
  dermis_source source = DERMIS_SOURCE_INIT;
  dermis_report report = NULL;
  source.name = "graph.json";
  source.text = text;
  source.length = length;
  expect(loaded->validate(&source, &report) == expected, "the result of a validation");
  loaded->destroy(report);
}

int main(int argc, char** argv) {
  static char text[1 << 16], folder[4096], folder_after[4096];
  struct sigaction before[SIGNALS], after;
  char locale[256];
  int round, i, printed, out, error, rounding, tasks;
  size_t length;
  FILE* file;
  if (argc != 3 || (file = fopen(argv[2], "rb")) == NULL) return 2;
  length = fread(text, 1, sizeof text, file);
  fclose(file);

  setlocale(LC_ALL, "");
  strncpy(locale, setlocale(LC_ALL, NULL), sizeof locale - 1);
  if (getcwd(folder, sizeof folder) == NULL) return 2;
  fesetround(FE_UPWARD);
  rounding = fegetround();
  for (i = 1; i < SIGNALS; ++i)
    sigaction(i, NULL, &before[i]);
  tasks = threads();
  printed = open("/tmp", O_TMPFILE | O_RDWR, 0600);
  out = dup(1);
  error = dup(2);
  fflush(NULL);
  dup2(printed, 1);
  dup2(printed, 2);
  for (round = 0; round < LOADS; ++round) {
    const library loaded = load(argv[1]);
    use(&loaded, text, length, DERMIS_OK);
    use(&loaded, text, length / 2, DERMIS_ERROR_CONFIG);
    dlclose(loaded.handle);
    expect(dlopen(argv[1], RTLD_NOW | RTLD_NOLOAD) == NULL, "it can be unloaded");
  }
  fflush(NULL);
  length = (size_t)lseek(printed, 0, SEEK_END);
  dup2(out, 1);
  dup2(error, 2);
  expect(length == 0 || failures > 0, "it prints nothing");
  expect(threads() == tasks, "it makes no thread");
  expect(strcmp(locale, setlocale(LC_ALL, NULL)) == 0, "the locale stays");
  expect(getcwd(folder_after, sizeof folder_after) != NULL && strcmp(folder, folder_after) == 0, "the folder stays");
  expect(fegetround() == rounding, "the rounding mode stays");
  for (i = 1; i < SIGNALS; ++i) {
    sigaction(i, NULL, &after);
    expect(after.sa_handler == before[i].sa_handler, "signal handlers stay");
  }
  if (failures > 0) fprintf(stderr, "%d in all\n", failures);
  return failures > 0;
}
