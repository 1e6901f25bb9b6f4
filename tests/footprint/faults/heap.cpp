// Asks for the heap.
int* made(int value) { return new int(value); }
