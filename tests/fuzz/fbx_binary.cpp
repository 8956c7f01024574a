#include "tests/fuzz/fbx_binary.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "tests/fuzz/support.h"

namespace luxel::fuzz {
namespace {

/// More blocks in each other than luxel reads: its limit is met, the fuzzer's own stack is not.
constexpr int kDeepest = 600;

struct Node {
  std::string_view key;
  std::vector<std::string_view> values;  ///< quotes stay on
  std::vector<Node> children;
};

/// Takes words off the text: brackets, keys with their colon, values.
struct Words {
  std::string_view text;
  size_t at = 0;

  std::string_view next() {
    constexpr std::string_view kBlanks = " \t\r\n,";
    for (;;) {
      at = std::min(text.find_first_not_of(kBlanks, at), text.size());
      if (at == text.size() || text[at] != ';') break;
      at = std::min(text.find('\n', at), text.size());
    }
    const size_t start = at;
    if (at == text.size()) return {};
    if (text[at] == '{' || text[at] == '}') return text.substr(at++, 1);
    if (text[at] == '"')
      at = std::min(text.find('"', at + 1), text.size() - 1) + 1;
    else
      at = std::min(text.find_first_of(" \t\r\n,;{}\"", at + 1), text.size());
    return text.substr(start, at - start);
  }
};

/// The nodes before the closing bracket, or the end.
std::vector<Node> read_block(Words& words, int depth) {
  std::vector<Node> out;
  for (std::string_view word; !(word = words.next()).empty() && word != "}";) {
    if (word == "{") {
      if (depth == kDeepest) return out;
      std::vector<Node> children = read_block(words, depth + 1);
      if (!out.empty()) out.back().children = std::move(children);
    } else if (word.ends_with(':')) {
      out.push_back({word.substr(0, word.size() - 1), {}, {}});
    } else if (!out.empty()) {
      out.back().values.push_back(word);
    }
  }
  return out;
}

/// Where a node stands: what its values are depends on it.
struct Context {
  std::string_view section;  ///< the key of the outermost block
  int depth = 0;
};

class Writer {
 public:
  explicit Writer(bool wide) : word_(wide ? 8 : 4) {}

  template <class T>
  void number(T value, size_t bytes = sizeof(T)) {
    append_number(out_, uint64_t(value), bytes);
  }
  void real(double value) { number(std::bit_cast<uint64_t>(value)); }
  void letters(std::string_view text) {
    for (const char c : text) out_.push_back(std::byte(c));
  }

  void node(const Node& node, const Context& context) {
    const size_t start = out_.size();
    for (int k = 0; k < 3; ++k) number(uint64_t(0), word_);
    number(std::min<size_t>(node.key.size(), 255), 1);
    letters(node.key.substr(0, 255));
    const size_t values = out_.size();
    const size_t count = write_values(node, context);
    patch(start + word_, count), patch(start + 2 * word_, out_.size() - values);
    if (!is_array(node) && !node.children.empty()) {
      const Context inside{context.depth == 0 ? node.key : context.section, context.depth + 1};
      for (const Node& child : node.children) this->node(child, inside);
      end_of_block();
    }
    patch(start, out_.size());
  }
  void end_of_block() { out_.resize(out_.size() + 3 * word_ + 1); }
  std::vector<std::byte> take() { return std::move(out_); }

 private:
  static bool is_array(const Node& node) {
    return node.values.size() == 1 && node.values[0].starts_with('*') &&
           node.children.size() == 1 && node.children[0].key == "a";
  }
  void patch(size_t at, uint64_t value) { put_number(out_, at, value, word_); }

  size_t write_values(const Node& node, const Context& context) {
    if (is_array(node)) {
      write_array(node);
      return 1;
    }
    for (size_t k = 0; k < node.values.size(); ++k) write_value(node, k, context);
    return node.values.size();
  }

  void write_value(const Node& node, size_t k, const Context& context) {
    const std::string_view value = node.values[k];
    if (value.starts_with('"')) {
      write_string(
          value.substr(1, value.size() - (value.size() > 1 && value.ends_with('"') ? 2 : 1)));
      return;
    }
    const std::string text(value);
    const bool is_id = context.depth == 1 && ((context.section == "Objects" && k == 0) ||
                                              (node.key == "C" && (k == 1 || k == 2)));
    const bool is_property = node.key == "P" && node.values.size() > 1;
    const bool is_whole = is_property
                              ? node.values[1] == "\"int\"" || node.values[1] == "\"enum\"" ||
                                    node.values[1] == "\"bool\""
                              : text.find_first_of(".eE") == text.npos;
    if (is_id)
      letters("L"), number(std::strtoll(text.c_str(), nullptr, 10));
    else if (is_whole)
      letters("I"), number(int32_t(std::strtoll(text.c_str(), nullptr, 10)));
    else
      letters("D"), real(std::strtod(text.c_str(), nullptr));
  }

  /// "Model::floor" is "floor", two bytes, "Model" in binary.
  void write_string(std::string_view text) {
    std::string out(text);
    if (const size_t at = text.find("::"); at != text.npos) {
      out = std::string(text.substr(at + 2)) + std::string("\0\1", 2);
      out += text.substr(0, at);
    }
    letters("S"), number(uint32_t(out.size())), letters(out);
  }

  void write_array(const Node& node) {
    constexpr std::array<std::string_view, 4> kWhole{"PolygonVertexIndex", "UVIndex", "Materials",
                                                     "Edges"};
    const bool whole = std::ranges::find(kWhole, node.key) != kWhole.end();
    const std::vector<std::string_view>& values = node.children[0].values;
    Writer raw(false);
    for (const std::string_view value : values) {
      const std::string text(value);
      if (whole)
        raw.number(int32_t(std::strtoll(text.c_str(), nullptr, 10)));
      else
        raw.real(std::strtod(text.c_str(), nullptr));
    }
    // The stated length is the text's, whether it is right or not.
    const std::string stated(node.values[0].substr(1));
    const bool deflated = values.size() % 2 == 0;
    std::vector<std::byte> bytes = raw.take();
    if (deflated) {
      uLongf length = compressBound(uLong(bytes.size()));
      std::vector<std::byte> packed(length);
      compress(reinterpret_cast<Bytef*>(packed.data()), &length,
               reinterpret_cast<const Bytef*>(bytes.data()), uLong(bytes.size()));
      packed.resize(length);
      bytes = std::move(packed);
    }
    letters(whole ? "i" : "d");
    number(uint32_t(std::strtoul(stated.c_str(), nullptr, 10)));
    number(uint32_t(deflated)), number(uint32_t(bytes.size()));
    out_.insert(out_.end(), bytes.begin(), bytes.end());
  }

  std::vector<std::byte> out_;
  size_t word_;
};

}  // namespace

std::vector<std::byte> binary_fbx(std::string_view text) {
  const bool wide = text.find("7500") != text.npos;
  Words words{text};
  Writer out(wide);
  out.letters(std::string_view("Kaydara FBX Binary  \0\x1a\0", 23));
  out.number(uint32_t(wide ? 7500 : 7400));
  for (const Node& node : read_block(words, 0)) out.node(node, {});
  out.end_of_block();
  return out.take();
}

}  // namespace luxel::fuzz
