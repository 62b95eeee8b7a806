/* For leak checking: drivers and layers stay loaded, so that a leak of theirs can be told by the module's name
 * (tests/lsan.supp). Linked into programs that are built with the address sanitizer alone. */
__attribute__((visibility("default"))) int dlclose(void* handle);

int dlclose(void* handle) {
  (void)handle;
  return 0;
}
