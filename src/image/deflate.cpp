// Each piece of the input is compressed as if nothing stood before it, and ends on a whole byte, with an empty stored
// block; so pieces are compressed in any order and stand one behind another. Within a piece: one candidate a position
// by a hash of four bytes, greedy; Huffman codes for every block of tokens (RFC 1951, "DEFLATE Compressed Data Format
// Specification", Deutsch, 1996). Lengths of codes by Moffat and Katajainen, "In-place calculation of
// minimum-redundancy codes", 1995, then shortened to what deflate allows.
#include "image/deflate.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <memory>

#include "base/check.h"

namespace candela {
namespace {

static_assert(std::endian::native == std::endian::little, "bits are gathered in little-endian words");

constexpr size_t piece_bytes = 128 << 10;
constexpr size_t block_bytes = 64 << 10;  // of input, behind which a block ends
constexpr size_t window = 32768, longest = 258;
constexpr int hash_bits = 14;
constexpr uint32_t end_of_block = 256;
constexpr int literal_symbols = 286, distance_symbols = 30;

constexpr std::array<uint16_t, 29> length_base = {3,  4,  5,  6,  7,  8,  9,  10, 11,  13,  15,  17,  19,  23, 27,
                                                  31, 35, 43, 51, 59, 67, 83, 99, 115, 131, 163, 195, 227, 258};
constexpr std::array<uint8_t, 29> length_extra = {0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2,
                                                  2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 0};
constexpr std::array<uint16_t, 30> distance_base = {1,    2,    3,    4,    5,    7,    9,    13,    17,    25,
                                                    33,   49,   65,   97,   129,  193,  257,  385,   513,   769,
                                                    1025, 1537, 2049, 3073, 4097, 6145, 8193, 12289, 16385, 24577};
constexpr std::array<uint8_t, 30> distance_extra = {0, 0, 0, 0, 1, 1, 2, 2,  3,  3,  4,  4,  5,  5,  6,
                                                    6, 7, 7, 8, 8, 9, 9, 10, 10, 11, 11, 12, 12, 13, 13};

constexpr std::array<uint8_t, 259> make_length_symbols() {
  std::array<uint8_t, 259> symbols{};
  for (size_t s = 0; s < length_base.size(); ++s)
    for (size_t length = length_base[s]; length <= longest; ++length) symbols[length] = uint8_t(s);
  return symbols;
}
constexpr std::array<uint8_t, 259> length_symbols = make_length_symbols();

// Of a distance of 1 or more: two symbols for each power of two.
uint32_t distance_symbol(uint32_t distance) {
  if (distance <= 2) return distance - 1;
  const uint32_t top = uint32_t(std::bit_width(distance - 1)) - 1;
  return 2 * top + (((distance - 1) >> (top - 1)) & 1);
}

// A literal, or a match: length - 3 above 16 bits, 1 above 24, distance - 1 below.
using Token = uint32_t;
constexpr Token is_match = 1u << 24;

class BitWriter {
 public:
  explicit BitWriter(std::vector<std::byte>& out) : out_(out) {}
  // Room for so many bytes, before put() and flush() that write them.
  void reserve(size_t bytes) {
    if (out_.size() < at_ + bytes + 8) out_.resize(at_ + bytes + 8);
  }
  void put(uint64_t bits, uint32_t count) {
    word_ |= bits << count_;
    count_ += count;
  }
  void flush() {  // at most 7 bits stay
    std::memcpy(out_.data() + at_, &word_, 8);
    at_ += count_ >> 3;
    word_ >>= count_ & ~7u;
    count_ &= 7;
  }
  void align() {
    count_ = (count_ + 7) & ~7u;
    flush();
  }
  void finish() { out_.resize(at_); }
  void set_begin(size_t at) { at_ = at; }
  size_t at() const { return at_; }
  void copy(const std::byte* bytes, size_t count) {  // aligned
    std::memcpy(out_.data() + at_, bytes, count);
    at_ += count;
  }

 private:
  std::vector<std::byte>& out_;
  size_t at_ = 0;
  uint64_t word_ = 0;
  uint32_t count_ = 0;
};

struct Codes {
  std::array<uint16_t, 288> code{};
  std::array<uint8_t, 288> length{};
};

// Lengths of the codes of sorted weights, ascending, in their place.
void minimum_redundancy(std::span<uint32_t> a) {
  const size_t n = a.size();
  if (n == 1) {
    a[0] = 1;
    return;
  }
  a[0] += a[1];
  size_t root = 0, leaf = 2;
  for (size_t next = 1; next + 1 < n; ++next) {
    const auto least = [&] {
      if (leaf >= n || (root < next && a[root] < a[leaf])) {
        const uint32_t weight = a[root];
        a[root++] = uint32_t(next);
        return weight;
      }
      return a[leaf++];
    };
    const uint32_t first = least();
    a[next] = first + least();
  }
  a[n - 2] = 0;
  for (size_t i = n - 2; i-- > 0;) a[i] = a[a[i]] + 1;
  size_t available = 1, used = 0, at = n;
  uint32_t depth = 0;
  for (size_t inner = n - 1; available > 0;) {
    while (inner > 0 && a[inner - 1] == depth) ++used, --inner;
    while (available > used) a[--at] = depth, --available;
    available = 2 * used;
    ++depth;
    used = 0;
  }
}

// No longer than `most` bits: too long ones get that many, and others give way until the codes fit again.
void limit_lengths(std::span<uint32_t> lengths, uint32_t most) {
  std::array<uint32_t, 33> counts{};
  for (const uint32_t length : lengths) ++counts[std::min(length, most)];
  uint64_t used = 0;
  for (uint32_t l = 1; l <= most; ++l) used += uint64_t(counts[l]) << (most - l);
  while (used > uint64_t(1) << most) {
    --counts[most];
    uint32_t shorter = most - 1;
    while (counts[shorter] == 0) --shorter;
    --counts[shorter];
    counts[shorter + 1] += 2;
    --used;
  }
  size_t at = lengths.size();
  for (uint32_t l = 1; l <= most; ++l)  // the heaviest are last and get the shortest
    for (uint32_t i = 0; i < counts[l]; ++i) lengths[--at] = l;
}

uint16_t reversed(uint32_t code, uint32_t length) {
  uint32_t result = 0;
  for (uint32_t i = 0; i < length; ++i) result |= (code >> i & 1) << (length - 1 - i);
  return uint16_t(result);
}

void make_codes(Codes& codes, std::span<const uint32_t> counts, uint32_t most) {
  std::array<uint64_t, 288> sorted{};
  std::array<uint32_t, 288> lengths{};
  size_t used = 0;
  for (size_t symbol = 0; symbol < counts.size(); ++symbol)
    if (counts[symbol] > 0) sorted[used++] = uint64_t(counts[symbol]) << 16 | symbol;
  codes.length.fill(0);
  if (used == 0) return;
  std::sort(sorted.begin(), sorted.begin() + long(used));
  for (size_t i = 0; i < used; ++i) lengths[i] = uint32_t(sorted[i] >> 16);
  minimum_redundancy(std::span(lengths).first(used));
  limit_lengths(std::span(lengths).first(used), most);
  for (size_t i = 0; i < used; ++i) codes.length[sorted[i] & 0xffff] = uint8_t(lengths[i]);
  std::array<uint32_t, 17> next{}, of_length{};
  for (size_t i = 0; i < used; ++i) ++of_length[lengths[i]];
  for (uint32_t l = 1, code = 0; l <= 15; ++l) {
    code = (code + of_length[l - 1]) << 1;
    next[l] = code;
  }
  for (size_t symbol = 0; symbol < counts.size(); ++symbol)
    if (const uint32_t length = codes.length[symbol]) codes.code[symbol] = reversed(next[length]++, length);
}

// The lengths of both alphabets, with runs (RFC 1951, 3.2.7).
struct LengthCode {
  uint8_t symbol, extra, extra_bits;
};
size_t encode_lengths(std::span<const uint8_t> lengths, std::span<LengthCode> out) {
  size_t n = 0;
  for (size_t i = 0; i < lengths.size();) {
    size_t run = 1;
    while (i + run < lengths.size() && lengths[i + run] == lengths[i]) ++run;
    i += run;
    const uint8_t length = lengths[i - 1];
    if (length == 0) {
      for (; run >= 11; run -= std::min<size_t>(run, 138)) out[n++] = {18, uint8_t(std::min<size_t>(run, 138) - 11), 7};
      if (run >= 3) out[n++] = {17, uint8_t(run - 3), 3}, run = 0;
    } else {
      out[n++] = {length, 0, 0}, --run;
      for (; run >= 3; run -= std::min<size_t>(run, 6)) out[n++] = {16, uint8_t(std::min<size_t>(run, 6) - 3), 2};
    }
    for (; run > 0; --run) out[n++] = {length, 0, 0};
  }
  return n;
}

class Piece {
 public:
  Piece() : tokens_(std::make_unique<Token[]>(block_bytes + 1)) {}
  void compress(std::vector<std::byte>& out, std::span<const std::byte> input);

 private:
  size_t find_tokens(const uint8_t* begin, const uint8_t* from, const uint8_t* end);
  void write_block(BitWriter& bits, std::span<const std::byte> input);
  void write_tokens(BitWriter& bits) const;

  std::array<uint32_t, 1u << hash_bits> newest_{};  // place of the newest four bytes of that hash, plus 1
  std::unique_ptr<Token[]> tokens_;
  size_t token_count_ = 0;
  std::array<uint32_t, 288> literal_counts_{}, distance_counts_{};
  Codes literals_, distances_;
};

uint32_t load32(const uint8_t* at) {
  uint32_t value;
  std::memcpy(&value, at, 4);
  return value;
}
uint64_t load64(const uint8_t* at) {
  uint64_t value;
  std::memcpy(&value, at, 8);
  return value;
}

size_t match_length(const uint8_t* a, const uint8_t* b, size_t most) {
  size_t length = 4;
  while (length + 8 <= most) {
    const uint64_t differs = load64(a + length) ^ load64(b + length);
    if (differs) return length + size_t(std::countr_zero(differs)) / 8;
    length += 8;
  }
  while (length < most && a[length] == b[length]) ++length;
  return length;
}

// Of filtered pictures literals have codes of few bits, and every match takes some of their weight away: measured,
// short matches make files larger (bench/README.md).
size_t least_length(uint32_t distance) { return distance <= 64 ? 8 : 12; }

// Tokens of [from, end), and how many bytes they are: a match is not cut at the end of a block.
size_t Piece::find_tokens(const uint8_t* begin, const uint8_t* from, const uint8_t* end) {
  literal_counts_.fill(0);
  distance_counts_.fill(0);
  token_count_ = 0;
  const uint8_t* at = from;
  const uint8_t* const last = end - from >= 8 ? end - 8 : from;
  while (at < last) {
    const uint32_t word = load32(at), hash = (word * 0x9e3779b1u) >> (32 - hash_bits);
    const uint32_t here = uint32_t(at - begin), before = newest_[hash];
    newest_[hash] = here + 1;
    if (before > 0) {
      const uint32_t distance = here - (before - 1);
      const uint8_t* match = begin + (before - 1);
      if (distance <= window && load32(match) == word) {
        const size_t length = match_length(at, match, std::min(longest, size_t(end - at)));
        if (length >= least_length(distance)) {
          tokens_[token_count_++] = is_match | uint32_t(length - 3) << 16 | (distance - 1);
          ++literal_counts_[257u + length_symbols[length]];
          ++distance_counts_[distance_symbol(distance)];
          at += length;
          continue;
        }
      }
    }
    ++literal_counts_[*at];
    tokens_[token_count_++] = *at++;
  }
  for (; at < end; ++at) {
    ++literal_counts_[*at];
    tokens_[token_count_++] = *at;
  }
  return size_t(at - from);
}

void Piece::write_tokens(BitWriter& bits) const {
  for (size_t i = 0; i < token_count_; ++i) {
    const Token token = tokens_[i];
    if (token < is_match) {
      bits.put(literals_.code[token], literals_.length[token]);
      if (i + 1 < token_count_ && tokens_[i + 1] < is_match) {
        const Token next = tokens_[++i];
        bits.put(literals_.code[next], literals_.length[next]);
      }
      bits.flush();
      continue;
    }
    const uint32_t length = (token >> 16 & 0xff) + 3, distance = (token & 0xffff) + 1;
    const uint32_t l = length_symbols[length], d = distance_symbol(distance);
    bits.put(literals_.code[257 + l], literals_.length[257 + l]);
    bits.put(length - length_base[l], length_extra[l]);
    bits.put(distances_.code[d], distances_.length[d]);
    bits.put(distance - distance_base[d], distance_extra[d]);
    bits.flush();
  }
  bits.put(literals_.code[end_of_block], literals_.length[end_of_block]);
  bits.flush();
}

void Piece::write_block(BitWriter& bits, std::span<const std::byte> input) {
  literal_counts_[end_of_block] = 1;
  make_codes(literals_, std::span(literal_counts_).first(literal_symbols), 15);
  make_codes(distances_, std::span(distance_counts_).first(distance_symbols), 15);
  const auto used = [](const Codes& codes, int most, int least) {
    while (most > least && codes.length[size_t(most - 1)] == 0) --most;
    return size_t(most);
  };
  const size_t literals = used(literals_, literal_symbols, 257), distances = used(distances_, distance_symbols, 1);
  std::array<uint8_t, literal_symbols + distance_symbols> lengths{};
  std::copy_n(literals_.length.begin(), literals, lengths.begin());
  std::copy_n(distances_.length.begin(), distances, lengths.begin() + long(literals));
  std::array<LengthCode, literal_symbols + distance_symbols> list;
  const size_t listed = encode_lengths(std::span(lengths).first(literals + distances), list);
  std::array<uint32_t, 19> counts{};
  for (size_t i = 0; i < listed; ++i) ++counts[list[i].symbol];
  Codes codes;
  make_codes(codes, counts, 7);
  constexpr std::array<uint8_t, 19> order = {16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};
  size_t ordered = 19;
  while (ordered > 4 && codes.length[order[ordered - 1]] == 0) --ordered;

  uint64_t size = 17 + 3 * ordered;  // bits
  for (size_t i = 0; i < listed; ++i) size += codes.length[list[i].symbol] + list[i].extra_bits;
  for (size_t s = 0; s < literals; ++s)
    size += uint64_t(literal_counts_[s]) * (literals_.length[s] + (s > 256 ? length_extra[s - 257] : 0u));
  for (size_t s = 0; s < distances; ++s)
    size += uint64_t(distance_counts_[s]) * (distances_.length[s] + distance_extra[s]);
  if (size >= 8 * uint64_t(input.size())) {  // stored, in blocks of at most 65535 bytes
    for (size_t from = 0; from < input.size();) {
      const size_t count = std::min<size_t>(input.size() - from, 65535);
      bits.reserve(count + 16);
      bits.put(0, 3);
      bits.align();
      bits.put(count | (~count & 0xffff) << 16, 32);
      bits.flush();
      bits.copy(input.data() + from, count);
      from += count;
    }
    return;
  }
  bits.reserve(size / 8 + 32);
  bits.put(0b100, 3);  // not the last; with codes of its own
  bits.put(literals - 257, 5);
  bits.put(distances - 1, 5);
  bits.put(ordered - 4, 4);
  bits.flush();
  for (size_t i = 0; i < ordered; ++i) {
    bits.put(codes.length[order[i]], 3);
    bits.flush();
  }
  for (size_t i = 0; i < listed; ++i) {
    bits.put(codes.code[list[i].symbol], codes.length[list[i].symbol]);
    bits.put(list[i].extra, list[i].extra_bits);
    bits.flush();
  }
  write_tokens(bits);
}

void Piece::compress(std::vector<std::byte>& out, std::span<const std::byte> input) {
  BitWriter bits(out);
  bits.set_begin(out.size());
  newest_.fill(0);
  const auto* begin = reinterpret_cast<const uint8_t*>(input.data());
  for (size_t from = 0; from < input.size();) {
    const size_t count = std::min(block_bytes, input.size() - from);
    const size_t taken = find_tokens(begin, begin + from, begin + from + count);
    write_block(bits, input.subspan(from, taken));
    from += taken;
  }
  bits.reserve(16);
  bits.put(0, 3);  // an empty stored block ends on a whole byte
  bits.align();
  bits.put(0xffff0000u, 32);
  bits.flush();
  bits.finish();
}

// RFC 1950, 9.
constexpr uint32_t adler_prime = 65521;
uint32_t adler32(std::span<const std::byte> bytes) {
  uint32_t a = 1, b = 0;
  constexpr size_t most = 5552;  // before b overflows
  for (size_t from = 0; from < bytes.size(); from += most) {
    for (const std::byte byte : bytes.subspan(from, std::min(most, bytes.size() - from))) a += uint8_t(byte), b += a;
    a %= adler_prime, b %= adler_prime;
  }
  return b << 16 | a;
}
// Of two parts, one behind the other.
uint32_t adler_of_both(uint32_t first, uint32_t second, size_t second_bytes) {
  const uint64_t n = second_bytes % adler_prime, a1 = first & 0xffff, b1 = first >> 16, a2 = second & 0xffff;
  const uint64_t a = (a1 + a2 + adler_prime - 1) % adler_prime;
  const uint64_t b = (b1 + (second >> 16) + n * (a1 + adler_prime - 1)) % adler_prime;
  return uint32_t(b << 16 | a);
}

}  // namespace

void append_zlib_stream(std::vector<std::byte>& out, std::span<const std::byte> input, bool threads) {
  const size_t pieces = (input.size() + piece_bytes - 1) / piece_bytes;
  const auto part = [&](size_t i) {
    return input.subspan(i * piece_bytes, std::min(piece_bytes, input.size() - i * piece_bytes));
  };
  out.push_back(std::byte{0x78});
  out.push_back(std::byte{0x01});
  uint32_t checksum = 1;
  if (threads && pieces > 1) {
    std::vector<std::vector<std::byte>> made(pieces);
    std::vector<uint32_t> checksums(pieces);
    tbb::parallel_for(size_t(0), pieces, [&](size_t i) {
      Piece().compress(made[i], part(i));
      checksums[i] = adler32(part(i));
    });
    for (size_t i = 0; i < pieces; ++i) {
      out.insert(out.end(), made[i].begin(), made[i].end());
      checksum = adler_of_both(checksum, checksums[i], part(i).size());
    }
  } else {
    const auto piece = std::make_unique<Piece>();
    for (size_t i = 0; i < pieces; ++i) {
      piece->compress(out, part(i));
      checksum = adler_of_both(checksum, adler32(part(i)), part(i).size());
    }
  }
  for (const uint8_t byte : {0x01, 0x00, 0x00, 0xff, 0xff}) out.push_back(std::byte(byte));  // the last block, empty
  for (int shift = 24; shift >= 0; shift -= 8) out.push_back(std::byte(checksum >> shift));
}

std::vector<std::byte> zlib_stream(std::span<const std::byte> input, bool threads) {
  std::vector<std::byte> out;
  append_zlib_stream(out, input, threads);
  return out;
}

}  // namespace candela
