using System;
using System.Globalization;
using System.Text;

namespace Pacinian.Tests
{
    /// <summary>Prints a JSON object as a line.</summary>
    internal static class ClientJson
    {
        /// <summary>Prints pairs of name and value: texts, numbers, booleans. Leaves out null.</summary>
        public static void Say(params object[] pairs)
        {
            StringBuilder text = new StringBuilder("{");
            for (int i = 0; i < pairs.Length; i += 2)
            {
                if (pairs[i + 1] != null)
                {
                    text.Append(text.Length > 1 ? "," : "").Append('"').Append(pairs[i]).Append("\":");
                    text.Append(Value(pairs[i + 1]));
                }
            }
            lock (Console.Out)
            {
                Console.Out.WriteLine(text.Append('}'));
                Console.Out.Flush();
            }
        }

        private static string Value(object value)
        {
            if (value is bool)
            {
                return (bool)value ? "true" : "false";
            }
            if (value is string || value is Enum)
            {
                return "\"" + value.ToString().Replace("\\", "\\\\").Replace("\"", "\\\"").Replace("\n", "\\n").Replace("\r", "\\r") + "\"";
            }
            double number = Convert.ToDouble(value, CultureInfo.InvariantCulture);
            bool finite = !double.IsNaN(number) && !double.IsInfinity(number);
            return finite ? number.ToString("R", CultureInfo.InvariantCulture) : "null";
        }
    }
}
