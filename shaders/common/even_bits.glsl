// Operations on words of flags.
#ifndef DERMIS_EVEN_BITS_GLSL
#define DERMIS_EVEN_BITS_GLSL

// Returns the even bits, packed.
uint even_bits(uint bits) {
  bits &= 0x55555555u;
  bits = (bits | bits >> 1) & 0x33333333u;
  bits = (bits | bits >> 2) & 0x0f0f0f0fu;
  bits = (bits | bits >> 4) & 0x00ff00ffu;
  return (bits | bits >> 8) & 0xffffu;
}

// Returns a word with the lowest `count` bits set, 0 to 32.
uint bits_below(int count) { return count < 32 ? (1u << uint(count)) - 1u : ~0u; }

#endif
