# Bullet in both precisions: PkgConfig::BULLET (float) and PkgConfig::BULLET_FLOAT64 (double).
# Take the definitions from these targets: BT_USE_DOUBLE_PRECISION comes with the second, and code compiled
# without it against the double libraries links and then crashes. find_package(Bullet) only ever finds float.

find_package(PkgConfig REQUIRED)
pkg_check_modules(BULLET IMPORTED_TARGET GLOBAL bullet>=3.0)
pkg_check_modules(BULLET_FLOAT64 IMPORTED_TARGET GLOBAL bullet-float64>=3.0)
if(NOT TARGET PkgConfig::BULLET OR NOT TARGET PkgConfig::BULLET_FLOAT64)
  message(FATAL_ERROR
    "pkg-config does not find Bullet in both precisions (bullet.pc and bullet-float64.pc); "
    "on Debian and Ubuntu, install libbullet-dev. "
    "The core does without it: build voxshell with -DVOXSHELL_BUILD_BULLET=OFF.")
endif()
