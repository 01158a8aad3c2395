#!/usr/bin/env bats
# Help, versions, progress, and what make and make install promise.
load helpers

commands=(guide lut match probe check report chart pack batch step params unpack stylize toon outline info validate compare init doctor bench)

# run_make TARGET...: with the variables of the build under test.
run_make() {
  local suffix=${STYLUT_BUILD##*/"$STYLUT_CONFIG"} arguments=(config="$STYLUT_CONFIG")
  [[ $suffix != *-nocgal ]] || arguments+=(CGAL=0)
  suffix=${suffix%-nocgal}
  [ -z "$suffix" ] || arguments+=(CC="${suffix#-}")
  make -s -C "$STYLUT_ROOT" "${arguments[@]}" "$@"
}

@test "--help of every command goes to stdout and exits 0" {
  local command form
  for form in --help '-?' help; do
    accept "$form"
    expect_match "$form" "$output" '^Usage: stylut COMMAND'
  done
  for command in "${commands[@]}"; do
    expect_holds 'stylut --help' "$output" "  $command "
  done
  for command in "${commands[@]}"; do
    accept "$command" --help
    expect_match "$command --help" "$output" "^Usage: stylut $command "
    expect_holds "$command --help" "$output" '--format=text|json'
    local shown=$output
    accept help "$command"
    expect "help $command" "$output" "$shown"
    accept "$command" '-?'
    accept "$command" --junk --help
  done
  # The tool lists no command that these tests don't know.
  accept --help
  expect commands "$(sed -nE 's/^  ([a-z]+) .*/\1/p' <<<"$output" | sort | tr '\n' ' ')" "$(printf '%s\n' "${commands[@]}" | sort | tr '\n' ' ')"
}

@test "options that --help lists are options" {
  local command option
  for command in "${commands[@]}"; do
    accept "$command" --help
    for option in $(grep -oE -- '--[a-z0-9-]+' <<<"$output" | sort -u); do
      [ "$option" != --help ] || continue
      said=$("$STYLUT" "$command" "$option=" 2>&1 >/dev/null) || true
      [[ $said != *"expected an option that"* ]] || complain "$command $option: $said"
    done
  done
}

@test "--version names licences and libraries" {
  accept --version
  expect_match version "$output" '^stylut [0-9]+\.[0-9]+\.[0-9]+
'
  local library
  for library in OpenImageIO Assimp Embree FLANN; do expect_match version "$output" "$library [0-9.]+"; done
  expect_holds version "$output" MIT
  if [[ ${STYLUT_BUILD##*/} = *-nocgal ]]; then
    expect_holds version "$output" 'not under the GPL'
    expect_holds version "$output" 'without CGAL'
  else
    expect_holds version "$output" 'GPL-3.0-or-later'
    expect_match version "$output" 'CGAL [0-9.]+'
  fi
  expect 'version of the Makefile' "$(sed -n '1s/stylut //p' <<<"$output")" "$(sed -n 's/^VERSION = //p' "$STYLUT_ROOT/Makefile")"
}

@test "make does nothing when nothing changed" {
  run_make -q all || complain "'make -q all' finds something to do: $(run_make -n all | head -n 3)"
}

# compile_with PACKAGE SOURCE: against the staged installation alone.
compile_with() {
  local flags=() extra=()
  export PKG_CONFIG_PATH=$PWD/stage/usr/lib/pkgconfig PKG_CONFIG_SYSROOT_DIR=$PWD/stage
  read -ra flags < <(PKG_CONFIG_ALLOW_SYSTEM_CFLAGS=1 PKG_CONFIG_ALLOW_SYSTEM_LIBS=1 pkg-config --cflags --libs "$1")
  [[ $STYLUT_CONFIG != sanitize ]] || extra+=(-fsanitize=address,undefined)
  [[ $STYLUT_CONFIG != coverage ]] || extra+=(--coverage)
  "${CC:-cc}" -std=c11 -Wall -Werror "${extra[@]}" -o "$2" "$2.c" "${flags[@]}" >compile.log 2>&1 ||
    { complain "$2.c: $(tail -n 5 compile.log)"; return 1; }
}

@test "make install, programs against it, make uninstall" {
  run_make install DESTDIR="$PWD/stage" prefix=/usr >make.log 2>&1 || { complain "make install: $(tail -n 3 make.log)"; return 1; }
  local file
  for file in bin/stylut lib/libstylut.a lib/libstylut_rt.a lib/libstylut_{oiio,embree,assimp,flann}.so lib/pkgconfig/libstylut.pc lib/pkgconfig/libstylut_rt.pc \
    include/stylut/runtime.h share/doc/stylut/LICENSE share/stylut/glsl/README.md share/stylut/glsl/common.glsl \
    share/stylut/glsl/330/transfer.frag share/stylut/glsl/es300/full_screen.vert share/man/man1/stylut.1 \
    share/man/man1/stylut-guide-scene.1 share/bash-completion/completions/stylut share/zsh/site-functions/_stylut; do
    [ -s "stage/usr/$file" ] || complain "usr/$file isn't installed"
  done
  ! grep -rqF "$PWD" stage/usr/lib/pkgconfig || complain "pkg-config files hold the staging folder"
  # The installed tool stands on its own.
  (
    STYLUT=$PWD/stage/usr/bin/stylut
    accept guide sphere -s 16 -o sphere.exr
    accept lut sphere.exr -s 16 -o lut.exr
  )
  command -v pkg-config >/dev/null || skip "no pkg-config"
  cat >small.c <<'EOF'
#include <stdio.h>
#include <stylut/runtime.h>
int main(void) {
  StyTexture texture;
  StyBlob blob = {"not a texture", 13};
  StyRuntimeStatus status = sty_open_texture(blob, STY_VK_R8G8_UNORM, &texture);
  puts(sty_describe_runtime_status(status));
  return status != STY_RUNTIME_NOT_KTX2;
}
EOF
  compile_with libstylut_rt small
  ./small >said.txt || complain "the program against libstylut_rt fails: $(cat said.txt)"
  expect 'version by pkg-config' "$(PKG_CONFIG_PATH=stage/usr/lib/pkgconfig pkg-config --modversion libstylut)" "$("$STYLUT" --version | sed -n '1s/stylut //p')"
  cat >large.c <<'EOF'
#include <stdio.h>
#include <stylut/guide.h>
#include <stylut/image_io.h>
#include <stylut/lut.h>
int main(void) {
  StyImage *guide = NULL;
  StySites *sites = NULL;
  StyLut *lut = NULL;
  const StyEngine *engine = NULL;
  const StyRun run = {2, NULL, NULL};
  StyError error;
  if (sty_make_sphere_guide(16, 16, STY_GUIDE_NORMAL, &guide, &error) || sty_collect_sites("sphere", guide, &sites, &error) ||
      sty_find_engine("engine", "flann-single", &engine, &error) ||
      sty_build_lut(sites, engine, NULL, &(StyLutSpec){.width = 16, .height = 16}, &run, &lut, &error)) {
    puts(error.text);
    return 1;
  }
  printf("%zu %u\n", sites->count, lut->pixels[8 * 16 + 8]);
  sty_destroy_lut(&lut);
  sty_destroy_sites(&sites);
  sty_destroy_image(&guide);
  return 0;
}
EOF
  compile_with libstylut large
  expect 'the program against libstylut' "$(LD_LIBRARY_PATH=$PWD/stage/usr/lib ./large)" '208 136'
  run_make uninstall DESTDIR="$PWD/stage" prefix=/usr >make.log 2>&1 || complain "make uninstall: $(tail -n 3 make.log)"
  expect 'files left behind' "$(find stage ! -type d)" ''
}

# A command that takes a while, so that there is progress to show.
long_work=(lut long.exr -s 300 -e brute -o out.exr)

@test "progress: silent in a pipe, a bar on a terminal, lines of JSON when asked for" {
  accept guide sphere -s 50 -o long.exr
  accept "${long_work[@]}"
  accept "${long_work[@]}" --progress none
  "$STYLUT" "${long_work[@]}" --progress json >/dev/null 2>progress.txt
  expect_less 'lines of progress' 3 "$(wc -l <progress.txt)"
  expect 'lines that are not progress' "$(grep -vcE '^\{"stage": "[a-z]+", "percent": [0-9]+, "left_s": (null|[0-9.]+)\}$' progress.txt)" 0
  expect 'percents in order' "$(json - 'r.every((p, i) => !i || p.percent >= r[i - 1].percent) && r[r.length - 1].percent' < <(sed -e '1s/^/[/; $s/$/]/; $!s/$/,/' progress.txt))" 100
  "$STYLUT" "${long_work[@]}" --progress bar >/dev/null 2>bar.txt
  expect_match 'bar when asked for' "$(tr '\r' '\n' <bar.txt | tail -n 2)" 'searching +\[#+\.*\] +[0-9]+ %'
  command -v script >/dev/null || skip "no script(1) to make a terminal with"
  script -qec "'$STYLUT' ${long_work[*]}" /dev/null </dev/null >terminal.txt 2>&1
  expect_match 'bar on a terminal' "$(tr '\r' '\n' <terminal.txt)" 'searching +\[#+\.*\] +[0-9]+ %'
  # The bar is wiped before the report.
  [[ $(cat terminal.txt) == *$'\e[K'*'out.exr: 300x300'* ]] || complain "the bar isn't wiped before the report"
  script -qec "'$STYLUT' ${long_work[*]} -q" /dev/null </dev/null >terminal.txt 2>&1
  expect 'quiet on a terminal' "$(cat terminal.txt)" ''
  script -qec "'$STYLUT' ${long_work[*]} --progress none -q" /dev/null </dev/null >terminal.txt 2>&1
  expect 'no progress on a terminal' "$(cat terminal.txt)" ''
}
