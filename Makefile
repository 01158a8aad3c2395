# stylut: one Makefile. `make help` lists the targets.
# Everything that is made lands in build/.

VERSION = 0.1.0

config ?= release
CGAL ?= 1
FUZZ_SECONDS ?= 60
prefix ?= /usr/local
bindir = $(prefix)/bin
libdir = $(prefix)/lib
# The image module, and where the tool looks for it, from its own folder.
moduledir = $(prefix)/lib
module_path = . ../lib
includedir = $(prefix)/include
docdir = $(prefix)/share/doc/stylut
glsldir = $(prefix)/share/stylut/glsl
mandir = $(prefix)/share/man/man1
bashdir = $(prefix)/share/bash-completion/completions
zshdir = $(prefix)/share/zsh/site-functions

ifeq ($(origin CC),default)
CC = gcc
endif
ifeq ($(origin CXX),default)
CXX = $(if $(findstring clang,$(CC)),clang++,g++)
endif
AR ?= ar

# What must be there before anything compiles, as Debian 12 packages.
BUILD_PACKAGES = gcc g++ libembree-dev libopenimageio-dev libpng-dev zlib1g-dev libflann-dev libassimp-dev libjansson-dev nettle-dev \
  $(if $(filter 1,$(CGAL)),libcgal-dev)
DEMO_PACKAGES = $(BUILD_PACKAGES) openimageio-tools fonts-dejavu-core ninja-build help2man
TEST_PACKAGES = $(DEMO_PACKAGES) clang libclang-rt-14-dev libomp-dev libcmocka-dev bats pkg-config chromium gnuplot-nox libxml2-utils man-db zsh slurm-wlm munge \
  libepoxy-dev libegl-dev libegl1 libgles2 libgl1 libgl1-mesa-dri
BENCH_PACKAGES = $(TEST_PACKAGES) libcgal-dev libnanoflann-dev apngasm assimp-testmodels time
DEB_PACKAGES = $(BUILD_PACKAGES) libcgal-dev debhelper dpkg-dev fakeroot help2man lintian debootstrap
STYLE_PACKAGES = clang-format shellcheck

# ---- configurations ---------------------------------------------------------
OPTIMIZE_release = -O3
OPTIMIZE_debug = -O0 -g -DSTY_DEBUG
# vptr would want clang's C++ runtime in programs that the C compiler links.
OPTIMIZE_sanitize = -O1 -g -DSTY_DEBUG -fsanitize=address,undefined -fno-sanitize=vptr \
  -fno-sanitize-recover=undefined -fno-omit-frame-pointer
OPTIMIZE_scalar = -O2 -fno-tree-vectorize
OPTIMIZE_coverage = -O0 -g --coverage
# For clang alone: `make fuzz` sees to that. As vptr, function would want the C++ runtime.
OPTIMIZE_fuzz = $(OPTIMIZE_sanitize) -fsanitize=fuzzer-no-link,float-cast-overflow \
  -fno-sanitize-recover=float-cast-overflow -fno-sanitize=function
ifeq ($(OPTIMIZE_$(config)),)
$(error config=$(config) is unknown; expected release, debug, sanitize, scalar, coverage or fuzz)
endif

# A folder per configuration and compiler, so that none ever mixes with another.
BUILD = build/$(config)$(if $(filter-out gcc,$(CC)),-$(notdir $(CC)))$(if $(filter-out 1,$(CGAL)),-nocgal)

# -ffp-contract=off: the same bytes from every compiler and processor. Nothing
# of ours asks libm for errno or waits for traps, which would keep square roots
# and choices from being vectors.
# No path of this machine, and no time, gets into what is built.
COMMON = $(OPTIMIZE_$(config)) -Wall -Wextra -Wshadow -Wvla -ffp-contract=off -fno-math-errno -fPIC -Iinclude -Isrc -MMD -MP \
  -ffile-prefix-map=$(CURDIR)=. -D_GNU_SOURCE -DSTY_VERSION='"$(VERSION)"' -isystem /usr/include/Imath $(if $(filter 1,$(CGAL)),-DSTY_WITH_CGAL)
CFLAGS_ALL = -std=c11 $(COMMON) -fno-trapping-math -Wstrict-prototypes -Wmissing-prototypes -fopenmp $(CFLAGS)
CXXFLAGS_ALL = -std=c++17 $(COMMON) -frounding-math $(CXXFLAGS)
# The runtime knows nothing of the rest, OpenMP and GNU extensions included.
RUNTIME_CFLAGS = -std=c11 $(filter-out -D_GNU_SOURCE,$(COMMON)) -Wstrict-prototypes -Wmissing-prototypes $(CFLAGS)
LIBRARIES = -ljansson -lnettle -lz \
  $(if $(filter 1,$(CGAL)),-lmpfr -lgmp) -lstdc++ -lm
LINK = $(CC) -fopenmp $(OPTIMIZE_$(config)) $(LDFLAGS)

# ---- what there is ----------------------------------------------------------
RUNTIME_SOURCES = $(wildcard src/runtime/*.c)
OIIO_SOURCES = src/bridge/oiio.cpp src/bridge/oiio_resize.cpp src/bridge/oiio_texture.cpp src/bridge/quiet_png.c
LIBRARY_SOURCES = $(filter-out $(RUNTIME_SOURCES) $(OIIO_SOURCES),$(wildcard src/*/*.c src/bridge/*.cpp))
TOOL_SOURCES = $(wildcard tools/*.c)
# Mesa doesn't get through in minutes where a sanitizer unwinds every allocation of its compiler.
TEST_SOURCES = $(filter-out $(if $(filter sanitize,$(config)),tests/shaders/%),$(wildcard tests/*/test_*.c))
BENCH_SOURCES = $(wildcard tests/bench/*.c)

objects = $(patsubst %,$(BUILD)/%.o,$(1))
RUNTIME_LIBRARY = $(BUILD)/libstylut_rt.a
LIBRARY = $(BUILD)/libstylut.a
OIIO_MODULE = $(BUILD)/libstylut_oiio.so
MODULES = $(OIIO_MODULE) $(patsubst %,$(BUILD)/libstylut_%.so,embree assimp flann)
TOOL = $(BUILD)/stylut
PAINT = $(BUILD)/paint
CREATURE = $(BUILD)/creature
EXAMPLES = $(BUILD)/use_runtime $(BUILD)/animate_runtime
TESTS = $(patsubst %.c,$(BUILD)/%,$(TEST_SOURCES))
# A shader for each dialect and pass: $(BUILD)/glsl/330/transfer.frag.
GLSL_PASSES = transfer look_up expand blend halve toon contours columns lines lay
SHADERS = $(foreach dialect,330 es300,$(BUILD)/glsl/$(dialect)/full_screen.vert \
  $(patsubst %,$(BUILD)/glsl/$(dialect)/%.frag,$(GLSL_PASSES)))
# Preloaded, it lets allocations fail.
FAULTS = $(BUILD)/tests/faults/fail_allocation.so
FUZZERS = $(patsubst %.c,$(BUILD)/%,$(wildcard tests/fuzz/fuzz_*.c))

.DELETE_ON_ERROR:
# Objects of tests and programs are kept, too.
.SECONDARY:

# What is built and how: when a source goes away or a flag changes, the stamp
# changes with it, and all that depends on it is made anew.
STAMP = $(BUILD)/stamp
STAMP_TEXT = $(sort $(LIBRARY_SOURCES) $(RUNTIME_SOURCES) $(TOOL_SOURCES)) $(CC) $(CXX) $(CFLAGS_ALL) $(CXXFLAGS_ALL) $(LDFLAGS)
$(shell mkdir -p $(BUILD); printf '%s' "$(subst ",\",$(STAMP_TEXT))" | cmp -s - $(STAMP) || \
  printf '%s' "$(subst ",\",$(STAMP_TEXT))" > $(STAMP))

.PHONY: all
all: $(TOOL) $(LIBRARY) $(RUNTIME_LIBRARY) $(EXAMPLES) $(SHADERS) ## build the tool, the libraries, shaders and the examples

$(TOOL): $(call objects,$(TOOL_SOURCES)) $(LIBRARY) $(RUNTIME_LIBRARY) | $(MODULES)
	$(LINK) $(call look_in,$(module_path)) -o $@ $^ $(LIBRARIES)

# What is opened when it is first used, see src/bridge/module.h.
$(OIIO_MODULE): $(call objects,$(OIIO_SOURCES)) $(LIBRARY)
	$(LINK) -shared -Wl,--exclude-libs,ALL -o $@ $^ -lOpenImageIO -lOpenImageIO_Util -lpng16 -lnettle -lstdc++ -lm
$(BUILD)/libstylut_%.so: $(STAMP)
	$(CC) -shared -Wl,--no-as-needed -Wl,-soname,$(@F) -o $@ $(LDFLAGS) $(LIBRARIES_$*)
LIBRARIES_embree = -lembree3
LIBRARIES_assimp = -lassimp
LIBRARIES_flann = -lflann -llz4
# $(call look_in,FOLDERS): where a program finds the modules, relative to itself. As
# RPATH, since sanitizers call dlopen in the program's stead.
look_in = -Wl,--disable-new-dtags $(patsubst %,-Wl$(comma)-rpath$(comma)'$$ORIGIN/%',$(1))
comma = ,

$(RUNTIME_LIBRARY): $(call objects,$(RUNTIME_SOURCES))
	@rm -f $@
	$(AR) rcsD $@ $^

$(LIBRARY): $(call objects,$(LIBRARY_SOURCES))
	@rm -f $@
	$(AR) rcsD $@ $^

$(BUILD)/src/runtime/%.c.o: src/runtime/%.c Makefile $(STAMP)
	@mkdir -p $(@D)
	$(CC) $(RUNTIME_CFLAGS) $(UNIT_CFLAGS) -c -o $@ $<

# Small where it isn't fast: all but the fast forms.
UNIT_CFLAGS = $(if $(filter release,$(config)),-O2)
$(BUILD)/src/runtime/runs_%.c.o: UNIT_CFLAGS =

# One source, several vector units; which runs is decided at run time.
ifeq ($(shell uname -m),x86_64)
$(BUILD)/%_avx2.c.o: CFLAGS_ALL += -mavx2
$(BUILD)/%_avx512.c.o: CFLAGS_ALL += -mavx512f -mavx512bw -mavx512dq -mavx512vl
$(BUILD)/src/runtime/%_avx2.c.o: UNIT_CFLAGS = -mavx2
$(BUILD)/src/runtime/%_avx512.c.o: UNIT_CFLAGS = -mavx512f -mavx512bw -mavx512dq -mavx512vl
endif

$(BUILD)/%.c.o: %.c Makefile $(STAMP)
	@mkdir -p $(@D)
	$(CC) $(CFLAGS_ALL) -c -o $@ $<

# They hold what they write.
$(BUILD)/tools/init.c.o $(BUILD)/tools/batch_slurm.c.o: $(wildcard tools/files/*)

$(BUILD)/%.cpp.o: %.cpp Makefile $(STAMP)
	@mkdir -p $(@D)
	$(CXX) $(CXXFLAGS_ALL) -c -o $@ $<

# What the assembler brings in, see there.
$(BUILD)/src/audit/html.c.o: src/audit/report.html src/audit/report.css src/audit/report.js
$(BUILD)/tools/bench.c.o: exemplars/charts/bench.csv

# Programs of one or a few sources beside the tool.
PAINT_SOURCES = $(wildcard exemplars/paint.c exemplars/paint/*.c)
$(PAINT): $(call objects,$(PAINT_SOURCES)) $(LIBRARY) | $(MODULES)
	$(LINK) $(call look_in,.) -o $@ $^ $(LIBRARIES)
$(CREATURE): $(call objects,exemplars/creature.c) $(LIBRARY)
	$(LINK) -o $@ $^ $(LIBRARIES)
# Nothing but the runtime: what a game would link.
$(EXAMPLES): $(BUILD)/%: $(BUILD)/exemplars/%.c.o $(RUNTIME_LIBRARY)
	$(CC) $(OPTIMIZE_$(config)) $(LDFLAGS) -o $@ $^ -lm

# The runtime's passes for graphics processors; how they are put together is said in src/runtime/glsl/README.md.
GLSL = src/runtime/glsl
$(BUILD)/glsl/%/full_screen.vert: $(GLSL)/head_%.glsl $(GLSL)/full_screen.glsl
	@mkdir -p $(@D)
	cat $^ > $@
define assemble_pass
$(BUILD)/glsl/%/$(1).frag: $(GLSL)/head_%.glsl $(GLSL)/common.glsl $(GLSL)/$(1).glsl
	@mkdir -p $$(@D)
	cat $$^ > $$@
endef
$(foreach pass,$(GLSL_PASSES),$(eval $(call assemble_pass,$(pass))))

# The shaders' twins are held together on Mesa's software renderer.
$(BUILD)/tests/shaders/%: LIBRARIES += -lepoxy
# What stylut is measured beside.
$(BUILD)/tests/bench/% $(BUILD)/tests/zoo/%: LIBRARIES += $(LIBRARIES_embree) $(LIBRARIES_assimp) $(LIBRARIES_flann)
$(BUILD)/tests/shaders/test_shaders $(BUILD)/tests/shaders/draw_frame: | $(SHADERS)

$(BUILD)/tests/%: $(BUILD)/tests/%.c.o $(LIBRARY) $(RUNTIME_LIBRARY) | $(MODULES)
	$(LINK) $(call look_in,../..) -o $@ $(filter %.o,$^) $(filter %.a,$^) $(LIBRARIES) -lcmocka

# Fuzz targets take what they are fed from libFuzzer in config=fuzz, else from files.
$(FAULTS): $(BUILD)/tests/faults/fail_allocation.c.o
	$(LINK) -shared -o $@ $<
$(FUZZERS): $(BUILD)/tests/fuzz/files.c.o
ifeq ($(config),fuzz)
$(FUZZERS): private LDFLAGS += -fsanitize=fuzzer
else
$(FUZZERS): $(BUILD)/tests/fuzz/replay.c.o
endif

# ---- packages ---------------------------------------------------------------
# $(call missing,PACKAGES): shell text that prints those not installed.
missing = for p in $(1); do dpkg-query -W -f='$${Status}' $$p 2>/dev/null | grep -q 'ok installed' || printf '%s ' $$p; done
# Node may well have come from elsewhere than Debian: its presence is what counts.
missing_node = command -v npm >/dev/null || printf 'nodejs npm '

.PHONY: deps
deps: ## install the Debian packages that building, demo and tests need
	@wanted=$$($(call missing,$(BENCH_PACKAGES) $(STYLE_PACKAGES) $(DEB_PACKAGES)); $(missing_node)); \
	if [ -n "$$wanted" ]; then as=; [ "$$(id -u)" = 0 ] || as=sudo; \
	  echo "installing: $$wanted"; \
	  $$as apt-get update && DEBIAN_FRONTEND=noninteractive $$as apt-get install -y --no-install-recommends $$wanted; fi

.PHONY: ensure-demo-packages ensure-test-packages ensure-bench-packages ensure-deb-packages
ensure-demo-packages:
	@[ -z "$$($(call missing,$(DEMO_PACKAGES)))" ] || $(MAKE) --no-print-directory deps
ensure-test-packages:
	@[ -z "$$($(call missing,$(TEST_PACKAGES)); $(missing_node))" ] || $(MAKE) --no-print-directory deps
ensure-bench-packages:
	@[ -z "$$($(call missing,$(BENCH_PACKAGES)); $(missing_node))" ] || $(MAKE) --no-print-directory deps
ensure-deb-packages:
	@[ -z "$$($(call missing,$(DEB_PACKAGES)))" ] || $(MAKE) --no-print-directory deps

# ---- demo, tests, bench -----------------------------------------------------
.PHONY: demo run-demo
demo: ensure-demo-packages ## mesh and painted spheres to stylized pictures: build/demo/contact.png
	@$(MAKE) --no-print-directory run-demo
run-demo: $(TOOL)
	@exemplars/demo.sh $(TOOL) build/demo

.PHONY: test run-tests
test: ensure-test-packages ## run every test (under 15 minutes on two cores)
	@$(MAKE) --no-print-directory run-tests
run-tests: all $(TESTS) $(FUZZERS) $(PAINT) $(BUILD)/tests/pack/write_ktx2 $(BUILD)/tests/shaders/draw_frame $(BUILD)/tests/bench/pieces $(BUILD)/tests/bench/big_mesh $(FAULTS)
	@CC='$(CC)' CXX='$(CXX)' tests/run.sh $(BUILD) $(config) $(TESTS)

.PHONY: fuzz run-fuzz
fuzz: ensure-test-packages ## feed every reader made-up files, FUZZ_SECONDS=60 each; with clang
	@$(MAKE) --no-print-directory config=fuzz CC=clang CXX=clang++ run-fuzz
run-fuzz: $(FUZZERS)
	@tests/fuzz/fuzz.sh $(BUILD) $(FUZZ_SECONDS) $(FUZZERS)

.PHONY: soak run-soak faults run-faults
soak: ensure-test-packages ## long runs: 2,000 frames by one process, 1,000 styles
	@$(MAKE) --no-print-directory run-soak
run-soak: $(TOOL)
	@tests/soak.sh $(TOOL) build/soak
faults: ensure-test-packages ## every allocation of every command fails in turn; signals at 200 moments of each
	@$(MAKE) --no-print-directory run-faults
run-faults: $(TOOL) $(FAULTS)
	@STYLUT=$(CURDIR)/$(TOOL) STYLUT_BUILD=$(CURDIR)/$(BUILD) STYLUT_CONFIG=$(config) STYLUT_ROOT=$(CURDIR) STYLUT_DATA= STYLUT_FAULTS=0 \
	  STYLUT_MOMENTS=200 bats tests/cli/faults.bats tests/cli/ended.bats

.PHONY: matrix reproduce
matrix: ensure-test-packages ## the demo by every compiler, vector unit and number of threads: the same bytes (an hour)
	@tests/matrix.sh build/matrix
reproduce: ensure-test-packages ## two builds in different folders: the same binaries
	@tests/reproduce.sh build/reproduce

.PHONY: bench
bench: ensure-bench-packages ## speed and memory beside a reference in the same run
	@$(MAKE) --no-print-directory run-bench
.PHONY: run-bench
run-bench: $(TOOL) $(BUILD)/tests/bench/bench $(BUILD)/tests/bench/decode $(BUILD)/tests/bench/engines
	@tests/bench/bench.sh $(BUILD)

# A mesh that fills memory rather than time: 1 GB of disk, 7 GB of memory.
.PHONY: giant run-giant
giant: ensure-bench-packages ## a guide of 50 million triangles: time by stage, peak memory, build/giant/giant.exr
	@$(MAKE) --no-print-directory run-giant
run-giant: $(TOOL) $(BUILD)/tests/bench/big_mesh
	@tests/bench/giant.sh $(BUILD) build/giant

# The libraries that ours is measured against.
$(BUILD)/tests/bench/decode: $(call objects,tests/bench/decode.cpp)
	$(LINK) -o $@ $^ -lOpenImageIO -lOpenImageIO_Util -lstdc++
$(BUILD)/tests/bench/engines: $(BUILD)/tests/bench/peers.cpp.o

# Guides that try to hurt a search, and what is said of them.
ZOO_OBJECTS = $(call objects,tests/zoo/cases.c tests/zoo/judge.c)
$(BUILD)/tests/zoo/test_zoo: $(ZOO_OBJECTS)
$(BUILD)/tests/zoo/zoo: $(ZOO_OBJECTS) $(call objects,tests/zoo/chance.cpp tests/bench/peers.cpp)

.PHONY: zoo run-zoo
zoo: ensure-bench-packages ## engines and raw libraries on guides that hurt: exemplars/charts/zoo.md; the importer on broken meshes
	@$(MAKE) --no-print-directory run-zoo
run-zoo: $(BUILD)/tests/zoo/zoo $(TOOL)
	@tests/zoo/models.sh $(TOOL)
	@$< > $(BUILD)/zoo.md && cp $(BUILD)/zoo.md exemplars/charts/.zoo.md && mv exemplars/charts/.zoo.md exemplars/charts/zoo.md

# The pictures and the models that stand in exemplars/, made anew.
.PHONY: artwork
artwork: $(PAINT) $(CREATURE) ## repaint the exemplars and make the models again
	@mkdir -p exemplars/spheres
	$(PAINT) exemplars/spheres
	$(CREATURE) exemplars/creature.ply
	exemplars/lit.sh exemplars/lit

# The README's pictures, from the demo's.
.PHONY: pictures
pictures: demo ## refresh the pictures that the README shows
	@exemplars/pictures.sh build/demo exemplars/pictures $(TOOL)

# Speed against accuracy; an idle machine, please. Other projects' guides join in where they are.
.PHONY: charts run-charts
charts: ensure-test-packages ## measure and draw exemplars/charts anew, but for its bench.csv
	@$(MAKE) --no-print-directory run-charts
run-charts: $(TOOL)
	@exemplars/charts.sh $(TOOL) exemplars/charts $(wildcard $(STYLUT_DATA))

# What guide scene --simplify leaves, and what that changes; times want an idle machine here, too.
.PHONY: simplification run-simplification
simplification: ensure-test-packages ## guide error, time and memory against triangles: exemplars/charts/simplify.csv and .svg
	@$(MAKE) --no-print-directory run-simplification
run-simplification: $(TOOL)
	@exemplars/simplify.sh $(TOOL) exemplars/charts

# What lut --resolve gives on turning figures; times want an idle machine here, too.
.PHONY: coherence run-coherence
coherence: ensure-bench-packages ## study of --resolve: exemplars/charts/coherence.csv and its pictures
	@$(MAKE) --no-print-directory run-coherence
run-coherence: $(TOOL) $(BUILD)/tests/bench/pieces
	@exemplars/coherence.sh $(TOOL) build/coherence
	@exemplars/coherence_pictures.sh $(TOOL) build/coherence exemplars/pictures
	@cp build/coherence/coherence.csv exemplars/charts/coherence.csv

# What stylize --anchor does for things that move.
.PHONY: motion run-motion
motion: ensure-test-packages ## study of --anchor: exemplars/charts/motion.csv and .svg
	@$(MAKE) --no-print-directory run-motion
run-motion: $(TOOL)
	@exemplars/motion.sh $(TOOL) build/motion exemplars/charts

# What helps flat surfaces.
.PHONY: flat run-flat
flat: ensure-test-packages ## study of scatter and --frame ray: exemplars/charts/flat.csv and a picture
	@$(MAKE) --no-print-directory run-flat
run-flat: $(TOOL)
	@exemplars/flat.sh $(TOOL) build/flat exemplars/charts exemplars/pictures

.PHONY: style
style: ## formatting, includes, shell scripts
	@tests/style.sh

# ---- install ----------------------------------------------------------------
.PHONY: install uninstall manual
# The date of a page is that of the sources.
manual: all ## manual pages of all commands, of what --help says: build/CONFIG/man
	@SOURCE_DATE_EPOCH=$${SOURCE_DATE_EPOCH:-$$(git log -1 --format=%ct 2>/dev/null || echo 0)} \
	  tools/shell/manual.sh $(TOOL) $(BUILD)/man $(VERSION)

install: manual ## install under $(prefix), with DESTDIR
	install -d $(DESTDIR)$(bindir) $(DESTDIR)$(moduledir) $(DESTDIR)$(libdir)/pkgconfig $(DESTDIR)$(includedir)/stylut $(DESTDIR)$(docdir)
	install -m 755 $(TOOL) $(DESTDIR)$(bindir)/stylut
	install -m 644 $(LIBRARY) $(RUNTIME_LIBRARY) $(DESTDIR)$(libdir)/
	install -m 644 $(MODULES) $(DESTDIR)$(moduledir)/
	install -m 644 include/stylut/*.h $(DESTDIR)$(includedir)/stylut/
	install -m 644 LICENSE README.md CHANGELOG.md $(DESTDIR)$(docdir)/
	install -d $(DESTDIR)$(mandir) $(DESTDIR)$(bashdir) $(DESTDIR)$(zshdir)
	install -m 644 $(BUILD)/man/*.1 $(DESTDIR)$(mandir)/
	install -m 644 tools/shell/completion.bash $(DESTDIR)$(bashdir)/stylut
	install -m 644 tools/shell/_stylut $(DESTDIR)$(zshdir)/
	install -d $(DESTDIR)$(glsldir)/330 $(DESTDIR)$(glsldir)/es300
	install -m 644 $(GLSL)/* $(DESTDIR)$(glsldir)/
	$(foreach dialect,330 es300,install -m 644 $(BUILD)/glsl/$(dialect)/* $(DESTDIR)$(glsldir)/$(dialect)/;)
	$(call pkgconfig,stylut_rt,runtime of stylut: reads bundles and stylizes frames,-lstylut_rt -lm)
	$(call pkgconfig,stylut,guides$(comma) look-up tables and bundles for example-based stylization,-lstylut -lstylut_rt $(LIBRARIES) -fopenmp -Wl$(comma)--disable-new-dtags$(comma)-rpath$(comma)$(moduledir))

pkgconfig = printf '%s\n' 'prefix=$(prefix)' 'libdir=$(libdir)' 'includedir=$(includedir)' '' 'Name: lib$(1)' \
  'Description: $(2)' 'Version: $(VERSION)' 'Cflags: -I$${includedir}' 'Libs: -L$${libdir} $(3)' \
  > $(DESTDIR)$(libdir)/pkgconfig/lib$(1).pc

uninstall: ## remove what install put there
	rm -f $(DESTDIR)$(bindir)/stylut $(DESTDIR)$(libdir)/libstylut.a $(DESTDIR)$(libdir)/libstylut_rt.a \
	  $(patsubst $(BUILD)/%,$(DESTDIR)$(moduledir)/%,$(MODULES))
	rm -f $(DESTDIR)$(mandir)/stylut.1 $(DESTDIR)$(mandir)/stylut-*.1 $(DESTDIR)$(bashdir)/stylut $(DESTDIR)$(zshdir)/_stylut
	rm -f $(DESTDIR)$(libdir)/pkgconfig/libstylut.pc $(DESTDIR)$(libdir)/pkgconfig/libstylut_rt.pc
	rm -rf $(DESTDIR)$(includedir)/stylut $(DESTDIR)$(docdir) $(DESTDIR)$(prefix)/share/stylut

.PHONY: deb check-deb
# Of what is committed or lies ready to be, in a folder of its own.
deb: ensure-deb-packages ## Debian packages of the tool, the library and the runtime: build/deb
	@rm -rf build/deb
	@mkdir -p build/deb/stylut-$(VERSION)
	@git ls-files -z --cached --others --exclude-standard | tar -c --null -T - | tar -x -C build/deb/stylut-$(VERSION)
	@cd build/deb/stylut-$(VERSION) && dpkg-buildpackage -b -us -uc
	@lintian --fail-on error,warning build/deb/*.changes
check-deb: deb ## install the packages in a clean Debian, and use them there
	@tests/deb.sh build/deb

.PHONY: clean
clean: ## remove build/
	rm -rf build

.PHONY: help
help: ## this list
	@echo 'make [TARGET] [config=release|debug|sanitize|scalar|coverage|fuzz] [CGAL=0] [CC=clang] [prefix=DIR] [DESTDIR=DIR]'
	@sed -n 's/^\([a-z][a-z-]*\):.*## \(.*\)/  \1\t\2/p' Makefile | expand -t 14

-include $(shell find $(BUILD) -name '*.d' 2>/dev/null)
