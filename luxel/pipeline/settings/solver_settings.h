// Settings that only one solver has.
#pragma once

#include <any>
#include <map>
#include <typeindex>

namespace luxel::pipeline {

/// One value of each type that was asked for: a solver's file says which type its settings have, so
/// that nobody else has to know them.
class SolverSettings {
 public:
  /// Made with its defaults at first.
  template <class T>
  T& of() {
    std::any& value = values_[typeid(T)];
    if (!value.has_value()) value = T{};
    return std::any_cast<T&>(value);
  }
  /// The defaults where nothing was set.
  template <class T>
  const T& of() const {
    static const T defaults{};
    const auto found = values_.find(typeid(T));
    return found == values_.end() ? defaults : std::any_cast<const T&>(found->second);
  }

 private:
  std::map<std::type_index, std::any> values_;
};

}  // namespace luxel::pipeline
