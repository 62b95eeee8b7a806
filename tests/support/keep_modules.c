/* For leak checking: drivers and layers stay loaded, so that reports of their own leaks contain the
 * module's name (tests/lsan.supp). Only linked into programs built with the address sanitizer. */
__attribute__((visibility("default"))) int dlclose(void* handle);

int dlclose(void* handle) {
  (void)handle;
  return 0;
}
