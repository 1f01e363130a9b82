// The mesh library (assimp 5.2) leaks memory when it rejects a damaged file; this must not hide
// leaks of our own from the leak sanitizer, which defines the function's name.
// NOLINTBEGIN(bugprone-reserved-identifier, readability-identifier-naming)
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libassimp\n"; }
// NOLINTEND(bugprone-reserved-identifier, readability-identifier-naming)
