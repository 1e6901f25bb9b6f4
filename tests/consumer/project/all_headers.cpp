// Every installed header, by the list that check.py writes.
#include "installed_headers.inc"

int main() {}
