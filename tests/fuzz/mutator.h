#pragma once
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

namespace candela::fuzz {

using Bytes = std::string;

// Damages glTF files, the same way for the same seed with every standard library. raw() works on bytes, so most of what
// it makes fails in the container or the JSON text; structured() keeps both whole and damages values, members and
// buffers, so that what it makes reaches the code behind.
class Mutator {
 public:
  Mutator(std::vector<Bytes> seeds, std::vector<Bytes> words, uint32_t seed);
  Bytes next();  // from one of the seeds
  void raw(Bytes& bytes);
  bool structured(Bytes& bytes);  // false, bytes unchanged: not a glTF file that parses

 private:
  using Json = nlohmann::json;
  size_t below(size_t n) { return n == 0 ? 0 : random_() % n; }
  template <class T>
  const T& pick(const std::vector<T>& from) {
    return from[below(from.size())];
  }
  void replace_number(Bytes& bytes);
  void splice(Bytes& bytes);
  void length_field(Bytes& bytes);
  void change_value(Json& value);
  void change_members(Json& value, const Json& other);
  void change_buffer(Bytes& buffer);
  void change_document(Json& document);

  std::vector<Bytes> seeds_, words_;
  std::mt19937 random_;
};

// The same document as a .glb.
Bytes as_glb(const Bytes& json, const Bytes& binary = {});

}  // namespace candela::fuzz
