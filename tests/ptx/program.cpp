#include "tests/ptx/program.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <unordered_map>

#include "tests/ptx/memory.hpp"
#include "tests/ptx/operations.hpp"

namespace ptx {
namespace {

struct Token {
  std::string_view text;
  int line;
};

std::vector<Token> tokens_of(std::string_view text) {
  std::vector<Token> tokens;
  int line = 1;
  const auto in_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || std::strchr("_$%.", c); };
  for (std::size_t k = 0; k < text.size();) {
    const char c = text[k];
    if (c == '\n') ++line;
    if (c == '\0' || std::isspace(static_cast<unsigned char>(c))) {
      ++k;
    } else if (c == '/' && k + 1 < text.size() && text[k + 1] == '/') {
      k = std::min(text.find('\n', k), text.size());
    } else {
      std::size_t end = k + 1;
      const bool number = c == '-' && end < text.size() && std::isdigit(static_cast<unsigned char>(text[end]));
      if (number || in_word(c))
        while (end < text.size() && in_word(text[end])) ++end;
      tokens.push_back({text.substr(k, end - k), line});
      k = end;
    }
  }
  return tokens;
}

int bytes_of(std::string_view type) { return type == ".pred" ? 1 : std::stoi(std::string(type.substr(2))) / 8; }
int aligned(int at, int to) { return (at + to - 1) / to * to; }

struct Declared {
  std::string name;
  int bytes = 0, align = 1;
};

struct Symbol {
  enum { row, local, shared, kernel_param, lane_param } kind;
  int at;
};
using Scope = std::unordered_map<std::string, Symbol>;

struct Function {
  std::vector<Declared> params, results;
  int first_param = 0, first_result = 0, entry = -1, begin = 0, end = 0, rows = 0;
  std::vector<int> param_at, result_at;
};

struct Operand {
  std::vector<int> rows;
  bool address = false, vector = false, negated = false, second = false;
  Space space = Space::generic;
  std::int64_t offset = 0;
  std::string name;
};

class Reader {
 public:
  explicit Reader(Program& program) : program_(program), tokens_(tokens_of(program.text)) {}

  void read() {
    while (at_ < tokens_.size()) {
      const auto word = take();
      if (word == ".version" || word == ".address_size") {
        take();
      } else if (word == ".target") {
        take();
        while (is(",")) take(), take();
      } else if (word == ".global" || word == ".const") {
        global();
      } else if (word == ".func") {
        function();
      } else if (word == ".entry") {
        entry();
      } else if (word != ".visible" && word != ".weak") {
        fail("not known at the top level");
      }
    }
    finish();
  }

 private:
  Program& program_;
  std::vector<Token> tokens_;
  std::size_t at_ = 0;
  std::map<std::string, Function> functions_;
  std::unordered_map<std::uint64_t, int> constant_rows_;
  int function_local_ = function_local_begin, function_param_ = function_param_begin;

  // of the body that is being read
  std::vector<Scope> scopes_;
  std::unordered_map<std::string, int> labels_;
  struct Jump {
    int instruction;
    std::string label;
  };
  std::vector<Jump> jumps_;
  int rows_ = 0, local_ = 0, lane_param_ = 0, shared_ = 0, carry_ = 0;
  bool in_kernel_ = false;

  [[noreturn]] void fail(const std::string& what) const {
    const int line = at_ > 0 ? tokens_[std::min(at_, tokens_.size()) - 1].line : 0;
    throw std::runtime_error("PTX line " + std::to_string(line) + ": " + std::string(program_.line(line)) + ": " +
                             what);
  }
  std::string_view take() {
    if (at_ >= tokens_.size()) throw std::runtime_error("PTX ends too early");
    return tokens_[at_++].text;
  }
  bool is(std::string_view text) const { return at_ < tokens_.size() && tokens_[at_].text == text; }
  bool take_if(std::string_view text) {
    if (!is(text)) return false;
    ++at_;
    return true;
  }
  void expect(std::string_view text) {
    if (take() != text) fail("expected " + std::string(text));
  }

  int constant(std::uint64_t value) {
    const auto [found, is_new] = constant_rows_.try_emplace(value, static_cast<int>(constant_rows_.size()));
    if (is_new) program_.constants.insert(program_.constants.end(), warp_size, value);
    return -1 - found->second;
  }
  std::uint64_t number(std::string_view text) const {
    if (text.starts_with("0d") || text.starts_with("0D") || text.starts_with("0f") || text.starts_with("0F"))
      return std::stoull(std::string(text.substr(2)), nullptr, 16);
    std::string digits(text);
    if (digits.back() == 'U') digits.pop_back();
    return digits[0] == '-' ? static_cast<std::uint64_t>(std::stoll(digits, nullptr, 0))
                            : std::stoull(digits, nullptr, 0);
  }

  /// `.align 8 .b8 name[64]`, `.u32 name`, after the space.
  Declared declared() {
    Declared is_declared;
    auto word = take();
    int align = 0;
    if (word == ".align") {
      align = std::stoi(std::string(take()));
      word = take();
    }
    const int element = bytes_of(word);
    is_declared.name = take();
    is_declared.bytes = element;
    is_declared.align = align ? align : element;
    if (take_if("[")) {
      is_declared.bytes = element * std::stoi(std::string(take()));
      expect("]");
    }
    return is_declared;
  }
  std::vector<Declared> parameters() {
    std::vector<Declared> found;
    expect("(");
    while (!take_if(")")) {
      expect(".param");
      found.push_back(declared());
      take_if(",");
    }
    return found;
  }

  void global() {
    const int element_at = static_cast<int>(at_);
    const Declared is_declared = declared();
    int element = 1;
    for (std::size_t k = element_at; k < at_; ++k)
      if (tokens_[k].text.size() >= 3 && tokens_[k].text[0] == '.' &&
          std::isdigit(static_cast<unsigned char>(tokens_[k].text[2])))
        element = bytes_of(tokens_[k].text);
    const auto size = static_cast<std::size_t>(is_declared.bytes);
    const std::uint64_t address = memory::allocate(size);
    memory::Fault fault;
    std::byte* bytes = memory::at(address, size, memory::Access::write, fault);
    std::memset(bytes, 0, size);
    if (take_if("=")) {
      const bool list = take_if("{");
      for (std::size_t k = 0;; ++k) {
        const std::uint64_t value = number(take());
        std::memcpy(bytes + k * element, &value, element);
        if (!take_if(",")) break;
      }
      if (list) expect("}");
    }
    expect(";");
    program_.variables[is_declared.name] = {address, size};
  }

  void function() {
    Function read;
    if (is("(")) read.results = parameters();
    const std::string name(take());
    if (is("(")) read.params = parameters();
    while (!is(";") && !is("{")) take();
    Function& f = functions_[name];
    if (f.param_at.empty() && f.result_at.empty()) {
      const auto place = [&](const std::vector<Declared>& list, std::vector<int>& at) {
        for (const Declared& d : list) {
          function_param_ = aligned(function_param_, 16);
          at.push_back(function_param_);
          function_param_ += d.bytes;
        }
      };
      place(read.params, f.param_at);
      place(read.results, f.result_at);
      if (function_param_ > lane_param_bytes) fail("too many parameters of functions");
    }
    f.params = read.params;
    f.results = read.results;
    if (take_if(";")) return;
    begin_body(false);
    for (std::size_t k = 0; k < f.params.size(); ++k)
      scopes_[0][f.params[k].name] = {Symbol::lane_param, f.param_at[k]};
    for (std::size_t k = 0; k < f.results.size(); ++k)
      scopes_[0][f.results[k].name] = {Symbol::lane_param, f.result_at[k]};
    f.entry = f.begin = static_cast<int>(program_.code.size());
    body();
    f.end = static_cast<int>(program_.code.size());
    f.rows = rows_ - special_rows;
  }

  void entry() {
    Kernel kernel;
    kernel.name = take();
    const auto params = parameters();
    begin_body(true);
    for (const Declared& d : params) {
      kernel.param_bytes = aligned(kernel.param_bytes, d.align);
      scopes_[0][d.name] = {Symbol::kernel_param, kernel.param_bytes};
      kernel.params.push_back({0, kernel.param_bytes, d.bytes});
      kernel.param_bytes += d.bytes;
    }
    while (!is("{"))
      if (take() == ".maxntid") kernel.threads_at_most = std::stoi(std::string(take()));
    kernel.entry = static_cast<int>(program_.code.size());
    body();
    kernel.registers = rows_;
    kernel.shared_bytes = shared_;
    program_.kernels[kernel.name] = kernel;
  }

  void begin_body(bool kernel) {
    scopes_.assign(1, {});
    static const std::pair<const char*, Special> specials[] = {{"%tid.x", tid_x},
                                                               {"%tid.y", tid_y},
                                                               {"%tid.z", tid_z},
                                                               {"%ntid.x", ntid_x},
                                                               {"%ntid.y", ntid_y},
                                                               {"%ntid.z", ntid_z},
                                                               {"%ctaid.x", ctaid_x},
                                                               {"%ctaid.y", ctaid_y},
                                                               {"%ctaid.z", ctaid_z},
                                                               {"%nctaid.x", nctaid_x},
                                                               {"%nctaid.y", nctaid_y},
                                                               {"%nctaid.z", nctaid_z},
                                                               {"%laneid", laneid},
                                                               {"%warpid", warpid},
                                                               {"%lanemask_eq", lanemask_eq},
                                                               {"%lanemask_lt", lanemask_lt},
                                                               {"%lanemask_le", lanemask_le},
                                                               {"%lanemask_gt", lanemask_gt},
                                                               {"%lanemask_ge", lanemask_ge}};
    for (const auto& [name, row] : specials) scopes_[0][name] = {Symbol::row, row};
    labels_.clear();
    jumps_.clear();
    rows_ = special_rows;
    shared_ = carry_ = 0;
    in_kernel_ = kernel;
    local_ = kernel ? 0 : function_local_;
    lane_param_ = kernel ? 0 : function_param_;
  }

  void body() {
    expect("{");
    scopes_.emplace_back();
    while (scopes_.size() > 1) {
      if (take_if("{")) {
        scopes_.emplace_back();
      } else if (take_if("}")) {
        scopes_.pop_back();
      } else if (take_if(".pragma")) {
        while (take() != ";") continue;
      } else if (is(".reg")) {
        registers();
      } else if (is(".local") || is(".shared") || is(".param")) {
        variable();
      } else if (at_ + 1 < tokens_.size() && tokens_[at_ + 1].text == ":") {
        labels_[std::string(take())] = static_cast<int>(program_.code.size());
        take();
      } else {
        instruction();
      }
    }
    for (const Jump& jump : jumps_) {
      const auto found = labels_.find(jump.label);
      if (found == labels_.end()) fail("no label " + jump.label);
      program_.code[jump.instruction].target = found->second;
    }
    Instruction last;
    last.kind = Kind::ret;
    program_.code.push_back(last);
    if (local_ > (in_kernel_ ? function_local_begin : local_bytes)) fail("too much local memory");
    if (lane_param_ > (in_kernel_ ? function_param_begin : lane_param_bytes)) fail("too many parameters");
    if (!in_kernel_) function_local_ = aligned(local_, 16), function_param_ = aligned(lane_param_, 16);
  }

  void registers() {
    take();
    take();  // the type: every register has 64 bits here
    do {
      const std::string name(take());
      if (take_if("<")) {
        const int count = std::stoi(std::string(take()));
        expect(">");
        for (int k = 0; k < count; ++k) scopes_.back()[name + std::to_string(k)] = {Symbol::row, rows_++};
      } else {
        scopes_.back()[name] = {Symbol::row, rows_++};
      }
    } while (take_if(","));
    expect(";");
  }
  void variable() {
    const auto space = take();
    const Declared d = declared();
    expect(";");
    int& end = space == ".local" ? local_ : space == ".shared" ? shared_ : lane_param_;
    end = aligned(end, std::max(d.align, 16));
    scopes_.back()[d.name] = {space == ".local"    ? Symbol::local
                              : space == ".shared" ? Symbol::shared
                                                   : Symbol::lane_param,
                              end};
    end += d.bytes;
  }

  const Symbol* find(std::string_view name) const {
    const std::string key(name);
    for (auto scope = scopes_.rbegin(); scope != scopes_.rend(); ++scope)
      if (const auto found = scope->find(key); found != scope->end()) return &found->second;
    return nullptr;
  }
  static bool is_number(std::string_view text) {
    return std::isdigit(static_cast<unsigned char>(text[0])) || (text[0] == '-' && text.size() > 1);
  }
  std::int64_t more() {  // +8, +-8, -8 after a name
    if (take_if("+")) return static_cast<std::int64_t>(number(take()));
    if (at_ < tokens_.size() && is_number(tokens_[at_].text) && tokens_[at_].text[0] == '-')
      return static_cast<std::int64_t>(number(take()));
    return 0;
  }
  /// A register, a number, or where a variable lies.
  int row_of(std::string_view text, Space* space = nullptr) {
    if (text == "_") return scratch();
    if (const Symbol* symbol = find(text)) {
      if (symbol->kind == Symbol::row) return symbol->at;
      if (space)
        *space = symbol->kind == Symbol::local          ? Space::local
                 : symbol->kind == Symbol::shared       ? Space::shared
                 : symbol->kind == Symbol::kernel_param ? Space::param
                                                        : Space::lane_param;
      return constant(static_cast<std::uint64_t>(symbol->at));
    }
    if (is_number(text)) return constant(number(text));
    if (const auto found = program_.variables.find(text); found != program_.variables.end())
      return constant(found->second.address);
    fail("no such name: " + std::string(text));
  }
  int scratch() {
    if (const Symbol* symbol = find("_ scratch")) return symbol->at;
    scopes_[0]["_ scratch"] = {Symbol::row, rows_++};
    return rows_ - 1;
  }

  Operand operand() {
    Operand o;
    if (take_if("{")) {
      o.vector = true;
      do o.rows.push_back(row_of(take()));
      while (take_if(","));
      expect("}");
    } else if (take_if("[")) {
      o.address = true;
      o.rows.push_back(row_of(take(), &o.space));
      o.offset = more();
      expect("]");
    } else {
      o.negated = take_if("!");
      const auto text = take();
      o.name = text;
      if (const Symbol* symbol = find(text);
          (symbol && symbol->kind != Symbol::row) || (!symbol && program_.variables.contains(text))) {
        const int row = row_of(text);
        const std::int64_t by = more();
        o.rows.push_back(by ? constant(program_.constants[static_cast<std::size_t>(-1 - row) * warp_size] +
                                       static_cast<std::uint64_t>(by))
                            : row);
      } else if (text[0] != '$') {
        o.rows.push_back(row_of(text));
      }
      if (take_if("|")) {
        o.rows.push_back(row_of(take()));
        o.second = true;
      }
    }
    return o;
  }

  void instruction() {
    Instruction i;
    i.line = tokens_[at_].line;
    if (take_if("@")) {
      i.guarded = true;
      i.unless = take_if("!");
      i.guard = row_of(take());
    }
    std::vector<std::string> parts;
    const std::string opcode(take());
    for (std::size_t begin = 0; begin <= opcode.size();) {
      const std::size_t end = std::min(opcode.find('.', begin), opcode.size());
      parts.push_back(opcode.substr(begin, end - begin));
      begin = end + 1;
    }
    if (parts[0] == "bra") {
      i.kind = Kind::branch;
      jumps_.push_back({static_cast<int>(program_.code.size()), std::string(take())});
      expect(";");
    } else if (parts[0] == "ret" || parts[0] == "exit") {
      i.kind = parts[0] == "ret" ? Kind::ret : Kind::end;
      expect(";");
    } else if (parts[0] == "call") {
      call(i);
    } else {
      operation(parts, i);
    }
    program_.code.push_back(i);
  }

  void call(Instruction& i) {
    i.kind = Kind::call;
    i.target = static_cast<int>(program_.calls.size());
    Call c;
    std::string result;
    if (take_if("(")) {
      result = take();
      expect(")");
      expect(",");
    }
    c.function = take();
    const auto found = functions_.find(c.function);
    if (found == functions_.end()) fail("no function " + c.function);
    const Function& f = found->second;
    const auto place = [&](std::string_view name) {
      const Symbol* symbol = find(name);
      if (!symbol || symbol->kind != Symbol::lane_param) fail("no parameter " + std::string(name));
      return symbol->at;
    };
    if (take_if(",")) {
      expect("(");
      for (std::size_t k = 0; !take_if(")"); ++k) {
        if (k >= f.params.size()) fail("too many arguments");
        c.arguments.push_back({place(take()), f.param_at[k], f.params[k].bytes});
        take_if(",");
      }
    }
    if (!result.empty()) c.result = {f.result_at.at(0), place(result), f.results[0].bytes};
    expect(";");
    program_.calls.push_back(c);
  }

  void operation(std::vector<std::string>& parts, Instruction& i) {
    std::vector<Operand> operands;
    while (!take_if(";")) {
      operands.push_back(operand());
      take_if(",");
    }
    const std::size_t n = operands.size();
    const std::string& name = parts[0];
    if (name == "mov" && n == 2 && (operands[0].vector || operands[1].vector)) {
      i.offset = std::stoi(parts.back().substr(1));
      parts[0] = operands[0].vector ? "unpack" : "pack";
    }
    const auto rows_to = [&](const Operand& o) {
      for (std::size_t k = 0; k < o.rows.size(); ++k) i.to[k] = o.rows[k];
      i.count = static_cast<std::uint8_t>(o.rows.size());
    };
    const auto address_from = [&](const Operand& o) {
      if (!o.address) fail("an address is expected");
      i.from[0] = o.rows[0];
      i.offset = o.offset;
      i.space = o.space;
    };
    if (name == "ld" && n == 2) {
      rows_to(operands[0]);
      address_from(operands[1]);
    } else if (name == "st" && n == 2) {
      address_from(operands[0]);
      i.count = static_cast<std::uint8_t>(operands[1].rows.size());
      for (std::size_t k = 0; k < operands[1].rows.size(); ++k) i.from[1 + k] = operands[1].rows[k];
    } else if (name == "atom" && n == 3) {
      rows_to(operands[0]);
      address_from(operands[1]);
      i.from[1] = operands[2].rows[0];
    } else if (name == "bar") {
      if (parts[1] == "warp")
        i.from[4] = operands.at(0).rows[0];
      else if (parts[1] == "red" && n == 3 && operands[1].name == "0" && !operands[2].negated)
        i.to[0] = operands[0].rows[0], i.from[0] = operands[2].rows[0];
      else if (n != 1 || operands[0].name != "0")
        fail("only whole blocks wait at a barrier here");
    } else if (parts[0] == "unpack") {
      rows_to(operands[0]);
      i.from[0] = operands[1].rows[0];
    } else if (parts[0] == "pack") {
      i.to[0] = operands[0].rows[0];
      i.count = static_cast<std::uint8_t>(operands[1].rows.size());
      for (std::size_t k = 0; k < operands[1].rows.size(); ++k) i.from[k] = operands[1].rows[k];
    } else if (n >= 1) {
      i.to[0] = operands[0].rows.at(0);
      if (operands[0].second) i.to[1] = operands[0].rows[1];
      if (operands[0].second && name != "shfl") fail("two results are not known here");
      if (n > 5) fail("too many operands");
      for (std::size_t k = 1; k < n; ++k) {
        i.from[k - 1] = operands[k].rows.at(0);
        if (operands[k].negated) {
          if (name != "vote" || i.guarded) fail("a negated source is not known here");
          i.unless = true;
        }
      }
      i.count = static_cast<std::uint8_t>(n - 1);
      if (name == "shfl") i.from[4] = i.from[3];
      if (name == "vote") i.from[4] = i.from[1];
      if (name == "setp" && n == 4 && std::find(parts.begin(), parts.end(), "and") == parts.end()) fail("not known");
    }
    const bool takes_carry = name == "addc" || name == "subc" || name == "madc";
    if (takes_carry && !carry_) fail("no carry");
    if (takes_carry || std::find(parts.begin(), parts.end(), "cc") != parts.end()) {
      if (!carry_) carry_ = rows_++;
      i.to[1] = carry_;
    }
    const Space named = i.space;
    if (!choose_operation(parts, i)) fail("not known");
    if (named != Space::generic) i.space = named;
    if (i.guarded && i.kind != Kind::plain) fail("a guard is not known here");
  }

  void finish() {
    int first = special_rows;
    for (const auto& [name, kernel] : program_.kernels) first = std::max(first, kernel.registers);
    for (const auto& [name, f] : functions_) {
      if (f.entry < 0) continue;
      const int by = first - special_rows;
      const auto move = [&](int& row) {
        if (row >= special_rows) row += by;
      };
      for (int k = f.begin; k < f.end; ++k) {
        Instruction& i = program_.code[k];
        move(i.guard);
        for (int& row : i.to) move(row);
        for (int& row : i.from) move(row);
      }
      first += f.rows;
    }
    program_.registers = first;
    for (Call& c : program_.calls) {
      c.entry = functions_.at(c.function).entry;
      if (c.entry < 0) throw std::runtime_error("PTX: " + c.function + " has no body");
    }
  }
};

}  // namespace

std::string_view Program::line(int number) const {
  std::size_t begin = 0;
  for (int k = 1; k < number && begin != std::string::npos; ++k) begin = text.find('\n', begin) + 1;
  return std::string_view(text).substr(begin, text.find('\n', begin) - begin);
}

std::unique_ptr<Program> read_program(std::string text) {
  auto program = std::make_unique<Program>();
  program->text = std::move(text);
  Reader(*program).read();
  return program;
}

}  // namespace ptx
