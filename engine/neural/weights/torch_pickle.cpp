// The pickle of a state dictionary, by a machine of some thirty steps (Python's Lib/pickletools.py describes
// them all).
#include "engine/neural/weights/torch_pickle.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <string_view>
#include <utility>
#include <variant>

#include "engine/base/error.h"

namespace gse::neural {
namespace {

constexpr std::size_t MostObjects = 10'000'000;  // a state dictionary has thousands
constexpr std::size_t DeepestDictionary = 4;
constexpr std::size_t LongestName = 1000;   // bytes of what is imported, of a key and of a storage's name
constexpr std::size_t MostDimensions = 64;  // PyTorch's own limit

struct Value;
using Values = std::vector<Value>;

/// Pickles take a value up again with two bytes: no copy of one may cost more than a pointer.
struct Text {
    std::shared_ptr<const std::string> held;
};
using Items = std::vector<std::pair<Text, Value>>;

struct Mark {};
struct Nothing {};  // None, and what is of no use here
struct Name {       // something that is imported
    Text text;
};
struct Storage {
    StoredType type;
    Text key;
    std::int64_t elements;
};
struct Sequence {  // tuple or list
    std::shared_ptr<Values> items;
};
struct Dictionary {
    std::shared_ptr<Items> items;
};

struct Tensor {
    std::shared_ptr<const StoredTensor> held;
};

struct Value {
    std::variant<Nothing, Mark, Name, bool, std::int64_t, double, Text, Sequence, Dictionary, Storage, Tensor>
        held;
};

Text text(std::string_view from) { return {std::make_shared<const std::string>(from)}; }

struct StorageName {
    const char* name;
    StoredType type;
};
constexpr StorageName StorageNames[] = {
    {"torch FloatStorage", StoredType::Float32},     {"torch HalfStorage", StoredType::Float16},
    {"torch BFloat16Storage", StoredType::BFloat16}, {"torch DoubleStorage", StoredType::Float64},
    {"torch LongStorage", StoredType::Int64},        {"torch IntStorage", StoredType::Int32},
    {"torch ShortStorage", StoredType::Int16},       {"torch CharStorage", StoredType::Int8},
    {"torch ByteStorage", StoredType::UInt8},        {"torch BoolStorage", StoredType::Bool}};

class Machine {
public:
    Machine(const std::string& bytes, const std::filesystem::path& path) : bytes_(bytes), path_(path) {}
    /// Containers may hold each other, in circles or a million deep: each is emptied while all are held.
    ~Machine() {
        for (const auto& list : lists_) list->clear();
        for (const auto& dictionary : dictionaries_) dictionary->clear();
    }
    Machine(const Machine&) = delete;
    Machine& operator=(const Machine&) = delete;

    /// Result of the program; valid as long as the machine.
    Value run() {
        for (;;) {
            const auto step = static_cast<unsigned char>(take(1)[0]);
            if (step == '.') return pop();
            if (!push_constant(step) && !push_container(step) && !remember(step) && !build(step))
                unknown_step(step);
            if (pushed_ + memory_.size() + lists_.size() + dictionaries_.size() > MostObjects)
                damaged("it holds too many objects");
        }
    }

private:
    [[noreturn]] void damaged(const char* what) const {
        throw Error(ErrorCode::Malformed, fmt::format("the weights file is damaged: {}", what),
                    "download it again", path_);
    }
    [[noreturn]] void refuse(const std::string& what) const {
        throw Error(
            ErrorCode::Unsupported,
            fmt::format("the pickled weights want to {}, and only files of plain tensors are read", what),
            "use a file of the weights alone (a state_dict), or convert it to .safetensors", path_);
    }
    [[noreturn]] void unknown_step(unsigned char step) const {
        refuse(fmt::format("take the step 0x{:02x}", step));
    }

    std::string_view take(std::uint64_t count) {
        if (count > bytes_.size() - at_) damaged("its description ends too soon");
        const std::string_view taken(bytes_.data() + at_, static_cast<std::size_t>(count));
        at_ += static_cast<std::size_t>(count);
        return taken;
    }
    std::uint64_t number(std::size_t bytes) {
        std::uint64_t value = 0;
        const auto taken = take(bytes);
        for (std::size_t i = 0; i < bytes; ++i)
            value |= std::uint64_t{static_cast<unsigned char>(taken[i])} << (8 * i);
        return value;
    }
    std::string_view line() {
        const auto end = bytes_.find('\n', at_);
        if (end == std::string::npos) damaged("its description ends too soon");
        const auto taken = take(end - at_);
        take(1);
        return taken;
    }
    Name name_of(std::string_view module, std::string_view name) const {
        if (module.size() + name.size() > LongestName) damaged("a name is too long");
        return {text(fmt::format("{} {}", module, name))};
    }

    void push(Value value) {
        stack_.push_back(std::move(value));
        ++pushed_;
    }
    Value pop() {
        if (stack_.empty()) damaged("its description takes more than it gave");
        Value value = std::move(stack_.back());
        stack_.pop_back();
        return value;
    }
    Values pop_to_mark() {
        const auto mark = std::find_if(stack_.rbegin(), stack_.rend(),
                                       [](const Value& v) { return std::holds_alternative<Mark>(v.held); });
        if (mark == stack_.rend()) damaged("its description takes more than it gave");
        Values items(std::make_move_iterator(mark.base()), std::make_move_iterator(stack_.end()));
        stack_.erase(mark.base() - 1, stack_.end());
        return items;
    }
    template <class T> const T& as(const Value& value, const char* what) const {
        if (const auto* held = std::get_if<T>(&value.held)) return *held;
        damaged(what);
    }
    Value sequence(Values items) {
        return {Sequence{lists_.emplace_back(std::make_shared<Values>(std::move(items)))}};
    }
    Value empty_dictionary() { return {Dictionary{dictionaries_.emplace_back(std::make_shared<Items>())}}; }
    Value last(std::size_t count) {
        Values items(count);
        for (std::size_t i = count; i-- > 0;) items[i] = pop();
        return sequence(std::move(items));
    }

    /// Whole number of `count` little-endian bytes with a sign, as Python's long.
    std::int64_t long_number(std::uint64_t count) {
        if (count > 8) damaged("it holds a number that is too large");
        if (count == 0) return 0;
        std::uint64_t value = number(static_cast<std::size_t>(count));
        if (count < 8 && (value >> (8 * count - 1) & 1) != 0) value |= ~std::uint64_t{0} << (8 * count);
        return static_cast<std::int64_t>(value);
    }

    bool push_constant(unsigned char step) {
        switch (step) {
            case 'N': push({Nothing{}}); return true;
            case 0x88: push({true}); return true;
            case 0x89: push({false}); return true;
            case 'K': push({static_cast<std::int64_t>(number(1))}); return true;
            case 'M': push({static_cast<std::int64_t>(number(2))}); return true;
            case 'J': push({std::int64_t{static_cast<std::int32_t>(number(4))}}); return true;
            case 0x8a: push({long_number(number(1))}); return true;
            case 'G': take(8), push({0.0}); return true;  // no floating-point number is used for anything
            case 'X': push({text(take(number(4)))}); return true;
            case 0x8c: push({text(take(number(1)))}); return true;
            case 'c': {
                const auto module = line();
                push({name_of(module, line())});
                return true;
            }
            case 0x93: {
                const auto name = pop(), module = pop();
                push({name_of(*as<Text>(module, "a name is no text").held,
                              *as<Text>(name, "a name is no text").held)});
                return true;
            }
            default: return false;
        }
    }

    bool push_container(unsigned char step) {
        switch (step) {
            case 0x80: take(1); return true;  // protocol
            case 0x95: take(8); return true;  // frame
            case '(': push({Mark{}}); return true;
            case ')':
            case ']': push(sequence({})); return true;
            case '}': push(empty_dictionary()); return true;
            case 't':
            case 'l': push(sequence(pop_to_mark())); return true;
            case 0x85: push(last(1)); return true;
            case 0x86: push(last(2)); return true;
            case 0x87: push(last(3)); return true;
            case 'a': {
                auto item = pop();
                list_below().items->push_back(std::move(item));
                return true;
            }
            case 'e': {
                auto items = pop_to_mark();
                auto& list = *list_below().items;
                list.insert(list.end(), std::make_move_iterator(items.begin()),
                            std::make_move_iterator(items.end()));
                return true;
            }
            case 's': {
                auto value = pop();
                auto key = pop();
                set_item(std::move(key), std::move(value));
                return true;
            }
            case 'u': {
                auto items = pop_to_mark();
                if (items.size() % 2 != 0) damaged("a key has no value");
                for (std::size_t i = 0; i < items.size(); i += 2)
                    set_item(std::move(items[i]), std::move(items[i + 1]));
                return true;
            }
            default: return false;
        }
    }

    bool remember(unsigned char step) {
        switch (step) {
            case 'q': memory_[number(1)] = top(); return true;
            case 'r': memory_[number(4)] = top(); return true;
            case 0x94: {
                const auto place = memory_.size();
                memory_[place] = top();
                return true;
            }
            case 'h': push(remembered(number(1))); return true;
            case 'j': push(remembered(number(4))); return true;
            default: return false;
        }
    }

    bool build(unsigned char step) {
        switch (step) {
            case 'Q': push({storage(pop())}); return true;
            case 'R': {
                const auto arguments = pop(), name = pop();
                push(call(*as<Name>(name, "what is called has no name").text.held,
                          as<Sequence>(arguments, "a call has no arguments")));
                return true;
            }
            case 'b':
                pop();
                return true;  // attributes of a dictionary (its _metadata): nothing depends on them
            default: return false;
        }
    }

    const Value& top() {
        if (stack_.empty()) damaged("its description takes more than it gave");
        return stack_.back();
    }
    const Value& remembered(std::uint64_t place) const {
        const auto found = memory_.find(place);
        if (found == memory_.end()) damaged("its description refers to nothing");
        return found->second;
    }
    const Sequence& list_below() { return as<Sequence>(top(), "it adds to what is no list"); }
    void set_item(Value key, Value value) {
        const auto& dictionary = as<Dictionary>(top(), "it adds to what is no dictionary");
        const auto* name = std::get_if<Text>(&key.held);
        if (name == nullptr) return;  // numbers as keys belong to optimisers
        if (name->held->size() > LongestName) damaged("a name is too long");
        dictionary.items->emplace_back(*name, std::move(value));
    }

    /// ("storage", type, key, device, elements)
    Storage storage(const Value& described) const {
        const auto& items = *as<Sequence>(described, "a storage is not described").items;
        if (items.size() != 5 || *as<Text>(items[0], "a storage is not described").held != "storage")
            damaged("a storage is not described");
        const auto& type = *as<Name>(items[1], "a storage has no type").text.held;
        const auto found = std::find_if(std::begin(StorageNames), std::end(StorageNames),
                                        [&](const StorageName& t) { return type == t.name; });
        if (found == std::end(StorageNames)) refuse(fmt::format("use \"{}\"", type));
        const auto elements = as<std::int64_t>(items[4], "a storage has no size");
        if (elements < 0) damaged("a storage has no size");
        const auto& key = as<Text>(items[2], "a storage has no name");
        if (key.held->size() > LongestName) damaged("a name is too long");
        return {found->type, key, elements};
    }

    Value call(const std::string& name, const Sequence& arguments) {
        const auto& items = *arguments.items;
        if (name == "collections OrderedDict" && items.empty()) return empty_dictionary();
        if (name == "torch._utils _rebuild_tensor_v2" && items.size() >= 4)
            return {Tensor{std::make_shared<const StoredTensor>(tensor(items))}};
        if (name == "torch._utils _rebuild_parameter" && !items.empty())
            return {as<Tensor>(items[0], "a parameter is no tensor")};
        if (name == "torch Size" && items.size() == 1) return items[0];
        refuse(fmt::format("call \"{}\"", name));
    }

    std::vector<std::int64_t> numbers(const Value& value) const {
        std::vector<std::int64_t> result;
        const auto& items = *as<Sequence>(value, "a shape is no list").items;
        if (items.size() > MostDimensions) damaged("a tensor has too many dimensions");
        for (const auto& item : items) {
            result.push_back(as<std::int64_t>(item, "a shape is no list of numbers"));
            if (result.back() < 0) damaged("a shape is negative");
        }
        return result;
    }

    /// Arguments are (storage, offset, shape, strides, ...). Everything lies inside the storage, and no
    /// number of it is used twice. Otherwise a small file could ask for any number of copies.
    StoredTensor tensor(const Values& items) const {
        const auto& from = as<Storage>(items[0], "a tensor has no storage");
        StoredTensor tensor{from.type,         *from.key.held,
                            from.elements,     as<std::int64_t>(items[1], "a tensor has no offset"),
                            numbers(items[2]), numbers(items[3])};
        if (tensor.shape.size() != tensor.strides.size() || tensor.offset < 0)
            damaged("a tensor is not described");
        std::int64_t reach = tensor.offset, count = 1;
        bool empty = false, overflow = false;
        for (std::size_t i = 0; i < tensor.shape.size(); ++i) {
            std::int64_t step = 0;
            empty = empty || tensor.shape[i] == 0;
            overflow = overflow ||
                       __builtin_mul_overflow(std::max<std::int64_t>(tensor.shape[i] - 1, 0),
                                              tensor.strides[i], &step) ||
                       __builtin_add_overflow(reach, step, &reach) ||
                       __builtin_mul_overflow(count, std::max<std::int64_t>(tensor.shape[i], 1), &count);
        }
        if (overflow || (!empty && reach >= tensor.elements)) damaged("a tensor reaches beyond its storage");
        if (!empty && count > tensor.elements)
            refuse(fmt::format("make a tensor of {} numbers from {}", count, tensor.elements));
        return tensor;
    }

    const std::string& bytes_;
    const std::filesystem::path& path_;
    std::size_t at_ = 0;
    std::size_t pushed_ = 0;  // values ever made, wherever they are now
    Values stack_;
    std::map<std::uint64_t, Value> memory_;
    std::vector<std::shared_ptr<Values>> lists_;
    std::vector<std::shared_ptr<Items>> dictionaries_;
};

/// Depth to which a dictionary was looked into. Others may name it any number of times.
using Depths = std::map<const Items*, std::size_t>;

/// The tensors of the dictionary; those of an inner one where it has none itself.
StoredTensors collect(const Dictionary& dictionary, std::size_t depth, Depths& seen) {
    StoredTensors tensors;
    const auto [known, first] = seen.try_emplace(dictionary.items.get(), depth);
    if (!first && known->second <= depth) return tensors;  // it had none
    known->second = depth;
    for (const auto& [name, value] : *dictionary.items)
        if (const auto* tensor = std::get_if<Tensor>(&value.held))
            tensors.insert_or_assign(*name.held, *tensor->held);
    if (!tensors.empty() || depth == DeepestDictionary) return tensors;
    for (const auto& [name, value] : *dictionary.items)
        if (const auto* inner = std::get_if<Dictionary>(&value.held);
            inner != nullptr && (*name.held == "state_dict" || *name.held == "model"))
            if (auto found = collect(*inner, depth + 1, seen); !found.empty()) return found;
    return tensors;
}

}  // namespace

StoredTensors read_tensor_pickle(const std::string& pickle, const std::filesystem::path& path) {
    Machine machine(pickle, path);
    const auto value = machine.run();
    const auto* dictionary = std::get_if<Dictionary>(&value.held);
    Depths seen;
    auto tensors = dictionary != nullptr ? collect(*dictionary, 0, seen) : StoredTensors{};
    if (tensors.empty())
        throw Error(ErrorCode::Unsupported, "the file holds no dictionary of tensors",
                    "use a file of the weights alone (a state_dict)", path);
    return tensors;
}

}  // namespace gse::neural
