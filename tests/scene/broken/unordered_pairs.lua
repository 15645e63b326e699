-- expect: :2: pairs: expected keys with an order (numbers, strings), got a table
for k in pairs({ [{}] = 1 }) do print(k) end
