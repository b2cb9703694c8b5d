# libshadowbias: make, make demo, make check, make bench, make peers,
#   make stability, make report (QUICK=1, PEERS=1), make readme-report, make install.
#   config=release|debug|sanitize|thread|coverage   V=1 shows the commands   CC=clang   CFLAGS,
#   PREFIX, DESTDIR

CC ?= cc
AR ?= ar
PREFIX ?= /usr/local
config ?= release
BUILD ?= build$(if $(filter-out release,$(config)),/$(config))

CFLAGS ?=
WARNINGS := -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wdouble-promotion
STRICT := -std=c11 -ffp-contract=off -fno-math-errno -D_POSIX_C_SOURCE=200809L
FLAGS_release := -O3 -DNDEBUG
FLAGS_debug := -O0 -g
FLAGS_sanitize := -O1 -g1 -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer
FLAGS_thread := -O1 -g1 -fsanitize=thread
FLAGS_coverage := -O0 -g --coverage
ifeq ($(FLAGS_$(config)),)
$(error config=$(config) is not one of release, debug, sanitize, thread, coverage)
endif
BASE := $(STRICT) $(WARNINGS) $(FLAGS_$(config)) -MMD -MP -Iinclude
FLAGS = $(BASE) $(CFLAGS)
LIBS := -lm -pthread

ifneq ($(V),1)
Q := @
endif

LIBRARY := $(BUILD)/libshadowbias.a
LIB_SRC := $(wildcard src/*.c src/kernels/*.c src/reference/*.c)
SUPPORT_SRC := $(wildcard examples/support/*.c)
EXAMPLES := $(patsubst examples/%.c,$(BUILD)/%,$(wildcard examples/*.c))
TEST_SRC := $(wildcard tests/*.c tests/support/*.c)
BENCH_SRC := $(wildcard tests/bench/*.c)
PEER_SUPPORT_SRC := $(addprefix tests/bench/peers/,comparison.c world_mesh.c)
STABILITY_SRC := $(wildcard tests/stability/*.c)
REPORT_SRC := $(wildcard examples/report/*.c)

object = $(patsubst %.c,$(BUILD)/obj/%.o,$(1))
EMULATED := $(patsubst %,$(BUILD)/obj/emulated/%.o,cpu kernels/kernels_avx512)
OBJECTS := $(EMULATED) $(call object,$(LIB_SRC) $(SUPPORT_SRC) $(TEST_SRC) $(BENCH_SRC) $(STABILITY_SRC) $(REPORT_SRC) $(wildcard examples/*.c tests/bench/peers/*.c))

all: $(LIBRARY) $(EXAMPLES) $(BUILD)/report

$(LIBRARY): $(call object,$(LIB_SRC))
	$(Q)rm -f $@
	$(Q)$(AR) rcs $@ $^

PROGRAMS := $(EXAMPLES) $(addprefix $(BUILD)/,check check_emulated bench stability report)

$(EXAMPLES): $(BUILD)/%: $(BUILD)/obj/examples/%.o
$(BUILD)/check_emulated: $(EMULATED)
$(BUILD)/check $(BUILD)/check_emulated: $(call object,$(TEST_SRC) \
		$(filter-out %/stability.c,$(STABILITY_SRC)) \
		$(filter-out %/report/report.c,$(REPORT_SRC)))
$(BUILD)/bench: $(call object,$(BENCH_SRC))
$(BUILD)/stability: $(call object,$(STABILITY_SRC))
$(BUILD)/report: $(call object,$(REPORT_SRC))

$(PROGRAMS): $(call object,$(SUPPORT_SRC)) $(LIBRARY)
	$(Q)$(CC) $(FLAGS) -o $@ $(filter %.o,$^) $(LIBRARY) $(LDFLAGS) $(LIBS)

REPORT_OUT := $(BUILD)/out/report

# The parts of the report's page become lists of quoted lines.
ASSETS := $(BUILD)/obj/examples/report/assets
PAGE := $(patsubst examples/report/%,$(ASSETS)/%.inc,$(wildcard examples/report/page.html \
	examples/report/page.css examples/report/page.js))

$(ASSETS)/%.inc: examples/report/%
	$(Q)mkdir -p $(@D)
	$(Q)sed 's/[\\"]/\\&/g; s/.*/"&\\n",/' $< > $@

$(call object,examples/report/assets.c): $(PAGE)
$(call object,examples/report/assets.c): FLAGS += -I$(ASSETS)

# Objects depend on the commands that made them, so that another CC or CFLAGS rebuilds.
STAMP := $(BUILD)/obj/flags
$(shell mkdir -p $(BUILD)/obj && echo '$(CC) $(FLAGS)' | cmp -s - $(STAMP) || echo '$(CC) $(FLAGS)' > $(STAMP))

$(BUILD)/obj/%.o: %.c $(STAMP)
	$(Q)mkdir -p $(@D)
	$(Q)$(CC) $(FLAGS) $(if $(filter src/%,$<),,-Iexamples/support -Itests/support -Itests/bench) -c -o $@ $<

# The tests with AVX-512 emulated: these objects come before their namesakes in the library.
$(BUILD)/obj/emulated/%.o: src/%.c $(STAMP)
	$(Q)mkdir -p $(@D)
	$(Q)$(CC) $(FLAGS) -O1 -mavx2 -Wno-psabi -include tests/support/emulated_avx512.h -c -o $@ $<

demo soft: %: $(BUILD)/%
	$(Q)mkdir -p $(BUILD)/out
	$(Q)$< $(BUILD)/out

check: $(BUILD)/check $(EXAMPLES)
	$(Q)$<

bench: $(BUILD)/bench
	$(Q)$<

# Other renderers, as far as their packages are installed.
PEER_LIBS_embree := -lembree3
PEER_LIBS_llvmpipe := -lEGL -lGLESv2
PEER_HEADER_embree := embree3/rtcore.h
PEER_HEADER_llvmpipe := GLES3/gl3.h
PEER_PACKAGES_embree := libembree-dev
PEER_PACKAGES_llvmpipe := libegl-dev libgles-dev libegl-mesa0

$(BUILD)/peers/%: $(BUILD)/obj/tests/bench/peers/%.o $(call object,$(PEER_SUPPORT_SRC) \
		$(filter-out %/bench.c,$(BENCH_SRC)) $(SUPPORT_SRC)) $(LIBRARY)
	$(Q)mkdir -p $(@D)
	$(Q)$(CC) $(FLAGS) -o $@ $(filter %.o %.a,$^) $(LDFLAGS) $(PEER_LIBS_$*) $(LIBS)

peers:
	$(Q)$(foreach peer,embree llvmpipe, \
		if echo '#include <$(PEER_HEADER_$(peer))>' | $(CC) -E - >/dev/null 2>&1; then \
			$(MAKE) --no-print-directory $(BUILD)/peers/$(peer) && \
			$(BUILD)/peers/$(peer) $(PEER_SCENES); \
		else \
			echo "skipped $(peer): install $(PEER_PACKAGES_$(peer))"; \
		fi;)

stability: $(BUILD)/stability
	$(Q)mkdir -p $(BUILD)/out
	$(Q)$(BUILD)/stability --out $(BUILD)/out

report: $(BUILD)/report
	$(Q)mkdir -p $(REPORT_OUT)
	$(if $(PEERS),$(Q)$(MAKE) --no-print-directory peers $(if $(QUICK),PEER_SCENES=hills) \
		>$(REPORT_OUT)/peers.txt && { grep '^skipped' $(REPORT_OUT)/peers.txt || true; })
	$(Q)$(BUILD)/report --out $(REPORT_OUT) $(if $(QUICK),--quick) \
		$(if $(PEERS),--peers $(REPORT_OUT)/peers.txt)

readme-report: $(BUILD)/report
	$(Q)$(BUILD)/report --out $(REPORT_OUT) $(if $(QUICK),--quick) --readme README.md

VERSION = $(shell awk '/_VERSION_/ { text = text dot $$3; dot = "." } END { print text }' \
	include/shadowbias/base.h)

ROOT = $(DESTDIR)$(PREFIX)

install: $(LIBRARY)
	$(Q)mkdir -p "$(ROOT)/lib/pkgconfig" "$(ROOT)/include/shadowbias"
	$(Q)cp $(LIBRARY) "$(ROOT)/lib/"
	$(Q)cp include/shadowbias/*.h "$(ROOT)/include/shadowbias/"
	$(Q)printf '%s\n' 'prefix=$(PREFIX)' 'Name: shadowbias' 'Description: shadow maps on the CPU' \
		"Version: $(VERSION)" 'Cflags: -I$${prefix}/include' \
		'Libs: -L$${prefix}/lib -lshadowbias -lm -pthread' \
		>"$(ROOT)/lib/pkgconfig/shadowbias.pc"
	@echo "installed to $(ROOT)"

clean:
	$(Q)rm -rf build

format:
	$(Q)clang-format -i $$(git ls-files '*.c' '*.h' '*.inl')

.PHONY: all demo soft check bench peers stability report readme-report install clean format
-include $(OBJECTS:.o=.d)
