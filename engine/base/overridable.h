// A number of a parameter struct that knows whether somebody has set it.
#pragma once

namespace gse {

/// A setting with a default that the program may override until a user, a file or a model sets the number.
/// Setting it to its default counts as setting it.
class Overridable {
public:
    explicit constexpr Overridable(double standard = 0) : standard_(standard), value_(standard) {}
    constexpr Overridable& operator=(double value) {
        value_ = value;
        set_ = true;
        return *this;
    }
    constexpr operator double() const { return value_; }
    constexpr bool is_set() const { return set_; }
    /// Tells whether the number is its default, set or not.
    constexpr bool is_standard() const { return value_ == standard_; }
    /// Gives a number that nobody has set another default.
    constexpr void override_if_unset(double value) {
        if (!set_) value_ = value;
    }
    /// Back to the default, as if nobody had set the number.
    constexpr void unset() { *this = Overridable(standard_); }
    /// Equal numbers differ where only one of them was set.
    friend constexpr bool operator==(const Overridable&, const Overridable&) = default;

private:
    double standard_, value_;
    bool set_ = false;
};

}  // namespace gse
