#include "gpu/specialize.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>
#include <unordered_set>

#include "gpu/spirv.h"

namespace candela::gpu {
namespace {

using namespace spirv;

struct Instruction {
  std::span<const uint32_t> words;
  uint32_t op() const { return words[0] & 0xffff; }
  size_t size() const { return words.size(); }
  uint32_t operator[](size_t i) const { return i < words.size() ? words[i] : 0; }
};

// What is left of a function: for each block its instructions, of which the last two may have become one branch.
struct Block {
  uint32_t label = 0;
  std::vector<Instruction> code;          // from behind the label
  std::optional<uint32_t> only_target{};  // of a branch whose way is known
  bool reached = false;
};
struct Function {
  std::vector<Instruction> head;  // to the first label
  std::vector<Block> blocks;
  std::vector<Instruction> whole;
  bool changed = false;
  std::set<std::pair<uint32_t, uint32_t>> edges;  // that are left, between labels
  std::vector<uint32_t> kept_merges;              // labels of merge blocks that nothing reaches
};

bool is_without_result(uint32_t op) {
  return op == op_store || op == op_copy_memory || op == op_copy_memory_sized || op == op_image_write ||
         op == op_control_barrier || op == op_memory_barrier || op == op_atomic_store ||
         (op >= op_loop_merge && op <= op_unreachable) || op == op_terminate_invocation || op >= first_without_name ||
         op == op_function_end;
}

class Specializer {
 public:
  Specializer(std::span<const uint32_t> spirv, std::span<const SpecConstant> constants) : spirv_(spirv) {
    for (const SpecConstant& constant : constants) given_[constant.id] = constant.value;
  }

  std::vector<uint32_t> run() {
    if (!parse()) return {spirv_.begin(), spirv_.end()};
    for (Function& function : functions_) reduce(function);
    find_called();
    return written();
  }

 private:
  using Value = std::optional<uint32_t>;

  Value value_of(uint32_t id) const {
    const auto found = values_.find(id);
    return found == values_.end() ? Value() : found->second;
  }

  // Of booleans and integers of 32 bits. operands: ids.
  Value evaluate(uint32_t op, std::span<const uint32_t> operands) const {
    std::array<Value, 3> v;
    for (size_t i = 0; i < std::min(operands.size(), v.size()); ++i) v[i] = value_of(operands[i]);
    const auto &a = v[0], &b = v[1];
    if (op == op_logical_and && ((a && !*a) || (b && !*b))) return 0;
    if (op == op_logical_or && ((a && *a) || (b && *b))) return 1;
    if (op == op_select && operands.size() == 3) return !a ? Value() : *a ? v[1] : v[2];
    if (!a) return {};
    if (op == op_logical_not) return !*a;
    if (op == op_copy_object) return a;
    if (!b || operands.size() != 2) return {};
    const int32_t sa = int32_t(*a), sb = int32_t(*b);
    switch (op) {
      case op_iadd:
        return *a + *b;
      case op_isub:
        return *a - *b;
      case op_imul:
        return *a * *b;
      case op_shift_left:
        return *b < 32 ? Value(*a << *b) : Value();
      case op_shift_right:
        return *b < 32 ? Value(*a >> *b) : Value();
      case op_bit_or:
        return *a | *b;
      case op_bit_xor:
        return *a ^ *b;
      case op_bit_and:
        return *a & *b;
      case op_logical_equal:
      case op_iequal:
        return *a == *b;
      case op_logical_not_equal:
      case op_inotequal:
        return *a != *b;
      case op_logical_or:
        return *a | *b;
      case op_logical_and:
        return *a & *b;
      case op_ugreater:
        return *a > *b;
      case op_ugreater_equal:
        return *a >= *b;
      case op_uless:
        return *a < *b;
      case op_uless_equal:
        return *a <= *b;
      case op_sgreater:
        return sa > sb;
      case op_sgreater_equal:
        return sa >= sb;
      case op_sless:
        return sa < sb;
      case op_sless_equal:
        return sa <= sb;
      default:
        return {};
    }
  }

  bool is_simple(uint32_t type) const { return simple_types_.contains(type); }

  void note_constant(const Instruction& i) {
    const uint32_t op = i.op(), id = i[2];
    if (!is_simple(i[1])) return;
    const auto spec = spec_ids_.find(id);
    const auto given = spec == spec_ids_.end() ? given_.end() : given_.find(spec->second);
    const bool is_given = given != given_.end();
    if (op == op_constant_true || op == op_constant_false) values_[id] = op == op_constant_true;
    if (op == op_spec_constant_true || op == op_spec_constant_false)
      values_[id] = is_given ? given->second != 0 : op == op_spec_constant_true;
    if (op == op_constant && i.size() == 4) values_[id] = i[3];
    if (op == op_spec_constant && i.size() == 4) values_[id] = is_given ? given->second : i[3];
    if (op == op_spec_constant_op)
      if (const Value value = evaluate(i[3], i.words.subspan(4))) values_[id] = *value;
  }

  // False: not what is known here.
  bool parse() {
    Function* function = nullptr;
    for (size_t at = header_words; at < spirv_.size();) {
      const size_t length = spirv_[at] >> 16;
      if (length == 0 || at + length > spirv_.size()) return false;
      const Instruction i{spirv_.subspan(at, length)};
      at += length;
      if (i.op() == op_function) function = &functions_.emplace_back();
      if (!is_without_result(i.op()) && long_.contains(i[1])) long_.insert(i[2]);
      if (!function) {
        if (i.op() == op_type_bool || (i.op() == op_type_int && i[2] == 32)) simple_types_.insert(i[1]);
        if (i.op() == op_type_int && i[2] > 32) long_.insert(i[1]);
        if (i.op() == op_decorate && i[2] == decoration_spec_id) spec_ids_[i[1]] = i[3];
        if (i.op() == op_entry_point) entries_.push_back(i[2]);
        note_constant(i);
        outside_.push_back(i);
        continue;
      }
      function->whole.push_back(i);
      if (i.op() == op_label)
        function->blocks.push_back({i[1], {}});
      else if (function->blocks.empty())
        function->head.push_back(i);
      else if (i.op() != op_function_end)
        function->blocks.back().code.push_back(i);
      if (i.op() == op_function_end) function = nullptr;
    }
    return !function;
  }

  void take_edge(Function& function, const Block& from, uint32_t to) {
    function.edges.insert({from.label, to});
    reached_.insert(to);
  }

  void note_phi(const Function& function, const Block& block, const Instruction& phi) {
    Value all;
    bool first = true;
    for (size_t k = 3; k + 1 < phi.size(); k += 2) {
      const uint32_t parent = phi[k + 1];
      if (!passed_.contains(parent)) return;  // a loop's
      if (!function.edges.contains({parent, block.label})) continue;
      const Value value = value_of(phi[k]);
      if (!value || (!first && value != all)) return;
      all = value, first = false;
    }
    if (all) values_[phi[2]] = *all;
  }

  // Which blocks are left. Blocks come behind those that dominate them.
  void reduce(Function& function) {
    if (function.blocks.empty()) return;
    reached_ = {function.blocks[0].label};
    passed_.clear();
    bool folded = false;
    for (Block& block : function.blocks) {
      passed_.insert(block.label);
      block.reached = reached_.contains(block.label);
      if (!block.reached) continue;
      if (block.code.empty()) return;
      for (const Instruction& i : block.code) {
        if (i.op() == op_phi)
          note_phi(function, block, i);
        else if (i.op() >= op_copy_object && i.op() <= op_bit_and && i.size() >= 4 && is_simple(i[1]))
          if (const Value value = evaluate(i.op(), i.words.subspan(3))) values_[i[2]] = *value;
      }
      const Instruction last = block.code.back();
      const bool selects = block.code.size() >= 2 && block.code[block.code.size() - 2].op() == op_selection_merge;
      if (last.op() == op_branch) take_edge(function, block, last[1]);
      if (last.op() == op_branch_conditional) {
        if (const Value way = selects ? value_of(last[1]) : Value()) {
          block.only_target = *way ? last[2] : last[3];
          take_edge(function, block, *block.only_target);
          folded = true;
        } else {
          take_edge(function, block, last[2]);
          take_edge(function, block, last[3]);
        }
      }
      if (last.op() == op_switch) {
        take_edge(function, block, last[2]);
        const size_t literal = long_.contains(last[1]) ? 2 : 1;
        for (size_t k = 3 + literal; k < last.size(); k += literal + 1) take_edge(function, block, last[k]);
      }
    }
    if (!folded) return;
    // What merges nowhere any more keeps its block; of other forms the function stays whole.
    for (const Block& block : function.blocks) {
      if (!block.reached && reached_.contains(block.label)) return;
      if (!block.reached || block.code.size() < 2 || block.only_target) continue;
      const Instruction merge = block.code[block.code.size() - 2];
      if (merge.op() == op_loop_merge && !reached_.contains(merge[2])) return;
      if ((merge.op() == op_selection_merge || merge.op() == op_loop_merge) && !reached_.contains(merge[1]))
        function.kept_merges.push_back(merge[1]);
    }
    function.changed = true;
  }

  template <class Visit>
  void for_each_kept(const Function& function, Visit visit) const {
    for (const Instruction& i : function.head) visit(i);
    for (const Block& block : function.blocks)
      if (block.reached || !function.changed)
        for (const Instruction& i : block.code) visit(i);
  }

  void find_called() {
    std::unordered_map<uint32_t, const Function*> by_id;
    for (const Function& function : functions_) by_id[function.whole[0][2]] = &function;
    std::vector<uint32_t> open = entries_;
    while (!open.empty()) {
      const uint32_t id = open.back();
      open.pop_back();
      if (!called_.insert(id).second || !by_id.contains(id)) continue;
      for_each_kept(*by_id[id], [&](const Instruction& i) {
        if (i.op() == op_function_call) open.push_back(i[3]);
      });
    }
  }

  void write(std::vector<uint32_t>& out, const Instruction& i) const {
    out.insert(out.end(), i.words.begin(), i.words.end());
  }
  static void write(std::vector<uint32_t>& out, uint32_t op, std::initializer_list<uint32_t> operands) {
    out.push_back(uint32_t(operands.size() + 1) << 16 | op);
    out.insert(out.end(), operands);
  }

  void note_dropped(const Instruction& i) {
    if (i.op() == op_label)
      dropped_.insert(i[1]);
    else if (!is_without_result(i.op()))
      dropped_.insert(i[2]);
  }

  void write_block(std::vector<uint32_t>& out, const Function& function, const Block& block) const {
    write(out, op_label, {block.label});
    if (!block.reached) return write(out, op_unreachable, {});
    const size_t own = block.code.size() - (block.only_target ? 2 : 0);
    for (size_t k = 0; k < own; ++k) {
      const Instruction& i = block.code[k];
      if (i.op() != op_phi) {
        write(out, i);
        continue;
      }
      const size_t head = out.size();
      write(out, Instruction{i.words.first(3)});
      for (size_t p = 3; p + 1 < i.size(); p += 2)
        if (function.edges.contains({i[p + 1], block.label})) out.insert(out.end(), {i[p], i[p + 1]});
      out[head] = uint32_t(out.size() - head) << 16 | op_phi;
    }
    if (block.only_target) write(out, op_branch, {*block.only_target});
  }

  std::vector<uint32_t> written() {
    std::vector<uint32_t> code;
    for (const Function& function : functions_) {
      if (!called_.contains(function.whole[0][2])) {
        for (const Instruction& i : function.whole) note_dropped(i);
        continue;
      }
      if (!function.changed) {
        for (const Instruction& i : function.whole) write(code, i);
        continue;
      }
      for (const Instruction& i : function.head) write(code, i);
      for (const Block& block : function.blocks) {
        const bool merges = std::ranges::find(function.kept_merges, block.label) != function.kept_merges.end();
        if (block.reached || merges) write_block(code, function, block);
        if (block.reached) continue;
        if (!merges) dropped_.insert(block.label);
        for (const Instruction& i : block.code) note_dropped(i);
      }
      write(code, op_function_end, {});
    }
    std::vector<uint32_t> out(spirv_.begin(), spirv_.begin() + header_words);
    for (const Instruction& i : outside_) {
      const bool names = i.op() == op_name || i.op() == op_decorate;
      if (!names || !dropped_.contains(i[1])) write(out, i);
    }
    out.insert(out.end(), code.begin(), code.end());
    return out;
  }

  std::span<const uint32_t> spirv_;
  std::map<uint32_t, uint32_t> given_;  // by constant_id
  std::unordered_map<uint32_t, uint32_t> spec_ids_, values_;
  std::unordered_set<uint32_t> simple_types_, reached_, passed_, called_, dropped_;
  std::unordered_set<uint32_t> long_;  // integers of 64 bits, types and values: literals of theirs take two words
  std::vector<uint32_t> entries_;
  std::vector<Instruction> outside_;  // of functions
  std::vector<Function> functions_;
};

}  // namespace

std::vector<uint32_t> specialized(std::span<const uint32_t> spirv, std::span<const SpecConstant> constants) {
  return Specializer(spirv, constants).run();
}

}  // namespace candela::gpu
