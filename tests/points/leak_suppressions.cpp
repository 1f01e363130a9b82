// The mesh library (assimp 5.2) does not free everything when it gives up on a damaged file; under
// the leak sanitizer that must not hide leaks of our own.
// The name is the sanitizer's.
// NOLINTBEGIN(bugprone-reserved-identifier, readability-identifier-naming)
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libassimp\n"; }
// NOLINTEND(bugprone-reserved-identifier, readability-identifier-naming)
