// Included before each source of wheels by tools/make_sysroot.sh. The C library's pow of 2.29 differs from the one
// before only in how it reports errors, but would keep wheels from systems with 2.28.
__asm__(".symver pow, pow@GLIBC_2.2.5");
