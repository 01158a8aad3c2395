#!/usr/bin/env bash
# Installs the Debian packages in a clean system and uses them there: the tool
# without what it only recommends, the libraries with a compiler. Wants root.
# Usage: deb.sh FOLDER-OF-PACKAGES
set -euo pipefail
packages=$(cd "$1" && pwd)
here=$(cd "$(dirname "$0")" && pwd)
root=$(mktemp -d)
chmod 755 "$root" # apt fetches as somebody else
trap 'umount -q "$root/proc" || true; rm -rf --one-file-system "$root"' EXIT
# shellcheck disable=SC2016 # apt's own names
mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Codename: bookworm' 'Component: main' | grep -v security | head -n 1)
debootstrap --variant=minbase bookworm "$root" "$mirror" >"$packages/debootstrap.log"
mount -t proc proc "$root/proc"
mkdir "$root/packages" "$root/work"
cp "$packages"/*.deb "$root/packages"
cp "$here/../exemplars/use_runtime.c" "$here/../exemplars/read_bundle.h" "$root/work"

# inside COMMAND...: in the clean system, as its root.
inside() { chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root DEBIAN_FRONTEND=noninteractive "$@"; }

inside apt-get update -qq
inside sh -c 'apt-get install -y -qq --no-install-recommends ./packages/stylut_*.deb' >"$packages/install.log" 2>&1
# shellcheck disable=SC2016 # for the shell inside
inside sh -ec 'cd /work
  stylut --version
  stylut doctor
  stylut init project
  stylut pack project/styles.json -o bundle
  stylut validate bundle
  stylut guide sphere -s 200 -o frame.exr
  stylut stylize bundle --guide frame.exr --style ink -o ink.png
  test -s ink.png'
inside sh -c 'apt-get install -y -qq ninja-build gcc libc6-dev pkg-config ./packages/libstylut-dev_*.deb ./packages/libstylut-rt-dev_*.deb' \
  >>"$packages/install.log" 2>&1
# shellcheck disable=SC2016 # for the shell inside
inside sh -ec 'cd /work
  stylut batch project/styles.json -o bundles --check
  cc use_runtime.c -o use_runtime $(pkg-config --cflags --libs libstylut_rt)
  ./use_runtime bundle >ring.ppm
  cat >lut.c <<C
#include <stdio.h>
#include <stylut/guide.h>
int main(void) {
  StyImage *guide = NULL;
  StyError error;
  if (sty_make_sphere_guide(64, 64, STY_GUIDE_NORMAL, &guide, &error)) return 1;
  printf("%d\n", guide->width);
  sty_destroy_image(&guide);
  return 0;
}
C
  cc lut.c -o lut $(pkg-config --cflags --libs libstylut)
  test "$(./lut)" = 64
  dpkg --purge libstylut-dev libstylut-rt-dev stylut >/dev/null
  test -z "$(ls -d /usr/bin/stylut /usr/lib/stylut /usr/include/stylut /usr/share/stylut 2>/dev/null)"'
printf 'the packages install, run and go away in a clean system\n'
