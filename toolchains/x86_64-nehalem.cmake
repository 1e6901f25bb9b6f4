# An x86-64 processor of 2008, emulated (qemu-user): it has SSE4.2, and programs die of their first AVX instruction.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-x86_64;-cpu;Nehalem)
