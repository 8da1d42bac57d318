// In builds for the address sanitizer libraries stay loaded: it can neither name nor find what a closed one
// still points to.
#if defined(__SANITIZE_ADDRESS__)
extern "C" int dlclose(void*) noexcept { return 0; }
#endif
