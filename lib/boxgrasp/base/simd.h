// Function multiversioning for the passes over all points.
#pragma once

// A function marked so is compiled once for each instruction set, and the best one for the machine is taken
// at load time. Only for free functions of a .cc file with plain loops over arrays. Reductions keep an
// explicit number of lanes, so that every version adds in the same order and gives the same bits; 32 where
// little is done in each, since g++ unrolls loops of up to 16 rounds before it vectorises them, and then does
// not. The least and the largest are found by orderedBits(), without lanes. Where more than ten pairs of
// pointers could overlap g++ gives up, too: then outputs are __restrict.
// Sanitizers instrument the load-time choice before they are ready for it, so sanitized builds keep to the
// plain version.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define BOXGRASP_SIMD __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define BOXGRASP_SIMD
#endif

// Marks their helpers: one that is not inlined would be compiled for the plainest machine.
#if defined(__GNUC__)
#define BOXGRASP_SIMD_PART [[gnu::always_inline]] inline
#else
#define BOXGRASP_SIMD_PART inline
#endif
