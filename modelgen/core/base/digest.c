/* Digests: 64-bit numbers that differ, but for a chance of about 2^-64, where what they are made of differs. Words are
   mixed in one after the other by multiplication and shifts. No protection against intent. */
#include <string.h>

#include "base/base.h"

/* The digest with one more word. */
static mg_digest mg_digest_word(mg_digest digest, mg_digest word) {
  digest = (digest ^ word) * 0xbf58476d1ce4e5b9ULL;
  digest = (digest ^ (digest >> 29)) * 0x94d049bb133111ebULL;
  return digest ^ (digest >> 32);
}

MG_INTERNAL mg_digest mg_digest_ints(mg_digest digest, const int *values, long n) {
  for (long i = 0; i < n; i++) digest = mg_digest_word(digest, (mg_digest)(long long)values[i]);
  return digest;
}

MG_INTERNAL mg_digest mg_digest_reals(mg_digest digest, const mg_real *values, long n) {
  for (long i = 0; i < n; i++) {
    const double high = (double)values[i];
    mg_digest word;
    memcpy(&word, &high, sizeof word);
    digest = mg_digest_word(digest, word);
    if (sizeof(mg_real) <= sizeof(double)) continue;
    const double low = (double)(values[i] - (mg_real)high);
    memcpy(&word, &low, sizeof word);
    digest = mg_digest_word(digest, word);
  }
  return digest;
}

MG_INTERNAL mg_digest mg_digest_text(mg_digest digest, const char *text) {
  for (; *text; text++) digest = mg_digest_word(digest, (unsigned char)*text);
  return digest;
}

MG_INTERNAL mg_digest mg_digest_bytes(mg_digest digest, const unsigned char *bytes, long n) {
  for (long i = 0; i < n; i += (long)sizeof(mg_digest)) {
    mg_digest word = 0;
    memcpy(&word, bytes + i, (size_t)(n - i) < sizeof word ? (size_t)(n - i) : sizeof word);
    digest = mg_digest_word(digest, word);
  }
  return digest;
}
