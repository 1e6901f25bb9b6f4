// A static made at the first call is made behind a lock.
int first(int value) {
  static const int kept = value;
  return kept;
}
