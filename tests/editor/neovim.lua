-- Neovim 0.7 or later: open a description, type a wrong name, apply the fix, rename a joint, write both files.
-- Arguments are in the environment: the Python of the server. What was seen is printed as JSON.
local seen = {}
local client = vim.lsp.start_client({ cmd = { vim.env.EURDF_PYTHON, "-m", "eurdf", "server" }, root_dir = vim.fn.getcwd() })

local function wait(until_true, what)
  if not vim.wait(30000, until_true, 20) then
    print(vim.fn.json_encode({ missed = what, seen = seen }))
    vim.cmd("cquit")
  end
end

local function find(word)
  vim.fn.cursor(1, 1)
  vim.fn.search(word, "cW")
end

vim.cmd("edit robot.yaml")
vim.lsp.buf_attach_client(0, client)
wait(function() return vim.lsp.buf_is_attached(0, client) end, "the server")
vim.cmd([[%s/rocker_pin_a/roker_pin_a/]])
wait(function() return #vim.diagnostic.get(0) == 1 end, "the diagnostic")
local found = vim.diagnostic.get(0)[1]
seen.diagnostic = { code = found.code, message = found.message, line = found.lnum + 1, column = found.col + 1 }

find("roker_pin_a")
local params = vim.lsp.util.make_range_params()
params.context = { diagnostics = {} }
for _, answer in pairs(vim.lsp.buf_request_sync(0, "textDocument/codeAction", params, 30000)) do
  seen.title = answer.result[1].title
  vim.lsp.util.apply_workspace_edit(answer.result[1].edit, "utf-16")
end
wait(function() return #vim.diagnostic.get(0) == 0 end, "the robot without errors")
seen.fixed = vim.api.nvim_buf_get_lines(0, 0, -1, false)

find("motor_crank")
vim.lsp.buf.rename("motor")
wait(function() return vim.fn.search("actuators: \\[motor\\]", "cw") > 0 end, "the new name")
vim.cmd("wall")
print(vim.fn.json_encode(seen))
vim.cmd("qall!")
