using System;
using System.Globalization;
using System.Text;

namespace Pacinian.Tests
{
    /// <summary>One JSON object in one line.</summary>
    internal static class ClientJson
    {
        /// <summary>Prints names and values in turn: texts, numbers, booleans; what is null is left out.</summary>
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
